/// An HDF5 file that all ranks write and that appears whole or not at all. Private to this room.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "output/hdf5.hpp"

namespace packmpi::output {

/// Collective. Writes PATH: to PATH.tmp, rows by all ranks, fsync'ed, renamed, the folder fsync'ed. `frame` makes all
/// of the file but the rows of `plan` (their datasets included) and runs on rank 0; `frame_bytes` is about what it
/// needs on the disk. Throws Error(io_failure) on every rank, with the system's reason; then PATH is untouched and
/// PATH.tmp is gone.
void write_whole_file(const comm::Comm& comm, const std::string& path, const std::vector<h5::Column>& plan,
                      std::int64_t frame_bytes, const std::function<void(hid_t file)>& frame);

}  // namespace packmpi::output
