/// From a TOML file to a checked Input.
#pragma once
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "config/named_files.hpp"
#include "input/input.hpp"

namespace packmpi::input {

/// What the command line changes of the file.
struct Overrides {
  std::vector<std::string> set;  ///< "key.path=value", the value in TOML syntax (bare words are taken as strings)
};

/// Collective. Rank 0 reads and parses, all ranks get the same Input or throw the same Error(bad_input), whose words
/// are one line "FILE:LINE: KEY: what is wrong; what to do". Unknown keys are errors with a suggestion. Ranges of
/// single keys and cross-checks that need no rank count are done here (checks/scene.cpp).
[[nodiscard]] Input read(const comm::Comm& comm, const std::string& path, const Overrides& overrides);

/// Rank-local part of read(): parse `text` as if it were the file `path`, with the files that it names. For tests and
/// fuzzing. Throws Error(bad_input).
[[nodiscard]] Input parse(const std::string& text, const std::string& path, const Overrides& overrides,
                          const NamedFiles& files = {});

/// The files that a scene names, read from the scene's folder. Local. Throws Error(bad_input).
[[nodiscard]] NamedFiles named_files(const std::string& text, const std::string& path, const Overrides& overrides);

/// The scene with every default filled in, as TOML, of an Input that was changed. Reading it gives the same scene and
/// the same text. Local.
[[nodiscard]] std::string effective_of(Input in);

/// doc/input.md's key tables, from the table the reader uses, as Markdown.
[[nodiscard]] std::string reference();

}  // namespace packmpi::input
