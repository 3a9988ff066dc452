/// May a run go on with this scene, and is a finished pack that of this scene?
#pragma once
#include <string>

#include "input/input.hpp"

namespace packmpi::pack {

/// How far the run is whose scene is compared.
enum class RunIs { unfinished, finished };

/// The keys that differ between two effective inputs and may not, as "key: A before, B now", joined by "; ". Empty: the
/// same run. All of [parallel], [checkpoint], [output] and [petsc] may change; of an unfinished run its length, too
/// (layers.maximum, if there is no final stage); of a finished one not whether it writes contacts. Local.
[[nodiscard]] std::string forbidden_changes(const std::string& before, const std::string& now,
                                            RunIs run = RunIs::unfinished);

/// In what other container particles would be cut or lose their neighbours: "a container of .., the scene in one of ..;
/// give that of the pack". Empty: floor and walls are the same. Local.
[[nodiscard]] std::string container_change(const input::Container& before, const input::Container& now);

/// Who wrote a checkpoint or a pack, of which scene.
struct Writer {
  std::string scene;         ///< the effective input
  std::string version, git;  ///< of the program
};

/// Whether that is this very program.
[[nodiscard]] bool is_this_program(const Writer& writer);

/// forbidden_changes() to the scene `now`. Keys that are new since that program wrote its scene have their defaults.
/// Local. Throws Error(bad_checkpoint) if the scene cannot be read any more: "WHAT: ...".
[[nodiscard]] std::string changes_since(const Writer& writer, const std::string& now, RunIs run,
                                        const std::string& what);

}  // namespace packmpi::pack
