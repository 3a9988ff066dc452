/// A run that is over, and is asked to go on.
#pragma once
#include <optional>
#include <string>

#include "base/error.hpp"
#include "comm/comm.hpp"
#include "run/options.hpp"
#include "scene/scene.hpp"

namespace packmpi::run {

/// What it came to.
struct Finished {
  ExitCode code;      ///< done or target_missed, as when the pack was made
  std::string words;  ///< one line for people
};

/// Collective. What the finished run of this scene came to, once all of its pack and its summary are found to be what
/// was written, of this scene and of each other; none if one of them is not there, or a checkpoint says that the run is
/// not over. An analysis that the scene wants and that is missing, or of another pack, is made. Throws
/// Error(bad_checkpoint) on all ranks: "FILE: what is wrong; what to do"; bad_input if another run with these outputs
/// is at work. Cost: one reading of the pack.
[[nodiscard]] std::optional<Finished> finished_run(const comm::Comm& comm, const scene::Scene& scene,
                                                   const Options& options);

}  // namespace packmpi::run
