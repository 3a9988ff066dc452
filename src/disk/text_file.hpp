/// Small files that rank 0 writes for all, and whether anything can be written at all.
#pragma once
#include <cstdint>
#include <string>

#include "comm/comm.hpp"

namespace packmpi::disk {

/// Collective. Writes `text` to `path` on rank 0: temporary, fsync, rename; throws Error(io_failure) on every rank.
void write_text(const comm::Comm& comm, const std::string& path, const std::string& text);

/// Collective. Throws Error(io_failure) unless `folder` exists or can be made, a file can be created in it, and `bytes`
/// of disk space are free. A folder that had to be made stays, unless the check fails; no file is left behind.
void check_writable(const comm::Comm& comm, const std::string& folder, std::int64_t bytes);

}  // namespace packmpi::disk
