/// What stands behind the end of every HDF5 file of ours: digests of all its bytes, so that nothing damaged is given to
/// HDF5, which trusts what a file says of itself. Private to this module.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "comm/comm.hpp"

namespace packmpi::disk {

/// The rows of a dataset, where they are in the file and what they are.
struct SealedRows {
  std::int64_t place = 0;      ///< [bytes] from the file's beginning
  std::int64_t rows = 0;       ///< of all ranks
  std::int64_t row_bytes = 0;  ///< [bytes] of one
  std::uint64_t digest = 0;    ///< rows_digest() of all, mod 2^64
};

struct Seal {
  std::vector<SealedRows> columns;
  std::int64_t end = 0;     ///< [bytes] of the file before the seal
  std::uint64_t frame = 0;  ///< frame_digest() of all that are no rows
};

/// A sum over the rows in `bytes`, the first of which has the number `first_row`: shares of a dataset may be added up
/// in any order, mod 2^64. Any one row changed, or put elsewhere, changes it. Local. Cost: O(bytes).
[[nodiscard]] std::uint64_t rows_digest(std::span<const std::byte> bytes, std::size_t row_bytes,
                                        std::int64_t first_row);

/// Gives `size` bytes of the file from `begin` on.
using ReadBytes = std::function<std::string(std::int64_t begin, std::int64_t size)>;

/// Of the file's bytes before the seal, but for the rows. Any one byte changed changes it.
[[nodiscard]] std::uint64_t frame_digest(const Seal& seal, const ReadBytes& read);

/// The seal as it stands in the file.
[[nodiscard]] std::string to_bytes(const Seal& seal);
/// A number that stands for all of it.
[[nodiscard]] std::uint64_t digest_of(const Seal& seal);

/// Rank-local. The seal of PATH, with all that are no rows verified: HDF5 may open it. Throws Error(io_failure), words
/// without the path.
[[nodiscard]] Seal check_frame(const std::string& path);

/// Rank-local. The sums of this rank's shares of the rows, a column each.
[[nodiscard]] std::vector<std::int64_t> row_digests(const std::string& path, const Seal& seal, Rank rank, int ranks);

/// Throws Error(io_failure), words without the path, unless the sums over all ranks are those of the seal.
void check_rows(const Seal& seal, std::span<const std::int64_t> digests);

}  // namespace packmpi::disk
