/// `packmpi info FILE`: what a pack or a checkpoint is.
#pragma once
#include <string>

#include "comm/comm.hpp"

namespace packmpi::cli {

/// Collective. Reads the file whole and verifies what can be: digests of a checkpoint, shapes and ids of a pack. The
/// words for the user, the same on all ranks. Throws Error(io_failure) on all ranks.
[[nodiscard]] std::string describe_file(const comm::Comm& comm, const std::string& path);

}  // namespace packmpi::cli
