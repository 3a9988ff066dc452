/// An HDF5 file that all ranks write and that appears whole or not at all. Private to this module.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "disk/hdf5.hpp"

namespace packmpi::disk {

/// Rows that come to the ranks that write them a piece at a time, so that a file takes little memory beside what it is
/// written of. bring(k) is collective: from then on each column holds its rows of piece k. One after another from 0 on;
/// what a column holds after its last row is not looked at.
struct Pieces {
  std::int64_t count = 1;
  std::function<void(std::int64_t piece)> bring = [](std::int64_t) {};  ///< as it is: all rows are at hand already
};

/// Collective. Where the `mine` rows of each rank lie in a dataset, rank after rank.
[[nodiscard]] h5::Slab slab_of(const comm::Comm& comm, std::int64_t mine);

/// Collective. Writes PATH: to PATH.tmp, rows by all ranks, a seal (output/seal.hpp) at the end, fsync'ed, renamed, the
/// folder fsync'ed. `frame` makes all of the file but the rows of `plan` (their datasets included) and runs on rank 0.
/// Throws Error(io_failure) on every rank, with the system's reason; then PATH is untouched (or, if it was the last
/// fsync that failed, the new file) and PATH.tmp is gone. So they are if `pieces` throws what all ranks agree on.
///
/// HDF5 touches no disk in it: rank 0 lets it write the headers to memory and copies them, and since all datasets are
/// contiguous every rank knows where its rows belong. Written by parallel HDF5 1.10 over MPI-IO instead, one failing
/// write can make H5Fclose wait for ever, or fail in a way that ends the program at its exit (both tried).
void write_whole_file(const comm::Comm& comm, const std::string& path, const std::vector<h5::Column>& plan,
                      const std::function<void(hid_t file)>& frame, const Pieces& pieces = {});

/// Bytes of the file that write_whole_file() would write, rows and seal included: `frame` makes it in memory, where
/// they are a hole; a name in the folder for temporary files is taken for a moment. Rank-local. Throws
/// Error(io_failure).
[[nodiscard]] std::int64_t whole_file_bytes(const std::vector<h5::Column>& plan,
                                            const std::function<void(hid_t file)>& frame);

}  // namespace packmpi::disk
