/// From the errors inside to those of the library's users. Private to this module.
#pragma once
#include <string>

#include "comm/comm.hpp"
#include "packmpi/failure.hpp"

namespace packmpi::library {

/// With file, line and key, if the words begin with `scene_file`, as those of input do: "FILE:LINE: KEY: ...". Local.
[[nodiscard]] Failure failure_of(const comm::Failure& failure, const std::string& scene_file);

/// Collective. Runs an action that may be collective, and throws what came of it on all ranks (comm::end_together).
template <class Action>
void together(const comm::Comm& comm, const std::string& scene_file, Action&& action) {
  const comm::Failure failure = comm::end_together(comm, action);
  if (failure.code != ExitCode::done) throw failure_of(failure, scene_file);
}

}  // namespace packmpi::library
