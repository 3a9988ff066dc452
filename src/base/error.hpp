/// The one exception of the program, and the exit codes it ends in.
#pragma once
#include <stdexcept>
#include <string>

namespace packmpi {

/// What the process returns to the shell; the same on every rank (doc/input.md, "Exit codes").
enum class ExitCode : int {
  done = 0,
  bad_input = 2,  ///< the command line, or a scene with its curve: wrong, or not there
  target_missed = 3,
  numerical_failure = 4,
  io_failure = 5,      ///< any other file: not there, damaged, not to be written
  bad_checkpoint = 6,  ///< --restart finds no checkpoint to go on from
  stopped_early = 75,
};

/// An error a user can act on: the words say what is wrong and what to do.
/// Throw it on all ranks at once (comm::agree). Thrown on one rank alone it ends the job: comm::end_together.
class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& words) : std::runtime_error(words), code_(code) {}
  [[nodiscard]] ExitCode code() const noexcept { return code_; }

 private:
  ExitCode code_;
};

}  // namespace packmpi
