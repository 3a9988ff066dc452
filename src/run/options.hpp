/// The command line as a plain struct.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "base/log.hpp"
#include "input/read.hpp"

namespace packmpi::run {

enum class Command { run, check, info };

/// What the user asked on the command line.
struct Options {
  Command command = Command::run;
  std::string scene;           ///< path of the TOML file; of any file for info
  std::string folder = ".";    ///< where outputs go
  input::Overrides overrides;  ///< --set, --seed
  bool force = false;          ///< existing outputs may be replaced
  std::string restart;         ///< "auto", a checkpoint file, or "": from the beginning
  double max_hours = 0.0;      ///< [h] of wall time, then a checkpoint and the end; 0: no limit
  std::int64_t max_steps = 0;  ///< of this run, then the same; 0: no limit
  log::Verbosity verbosity = log::Verbosity::normal;
};

/// Text to print and the exit code, for --help, --version and usage errors.
struct Reply {
  std::string text;
  int code = 0;
};

/// Local and pure: every rank sees the same argv and gets the same answer.
[[nodiscard]] std::variant<Options, Reply> parse_command_line(int argc, const char* const* argv);

}  // namespace packmpi::run
