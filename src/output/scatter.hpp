/// Rows to the rank that writes them: each rank owns one contiguous block of ids. Private to this room.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

#include "base/types.hpp"
#include "comm/comm.hpp"

namespace packmpi::output {

/// Ids [begin(r), begin(r + 1)) of 0 .. total-1 belong to rank r, in equal shares.
struct IdBlocks {
  std::int64_t total;
  std::int64_t ranks;

  [[nodiscard]] GlobalId begin(Rank rank) const { return total / ranks * rank + total % ranks * rank / ranks; }
  /// Precondition: 0 <= id < total.
  [[nodiscard]] Rank owner(GlobalId id) const {
    auto rank = static_cast<Rank>(static_cast<double>(id) / static_cast<double>(total) * static_cast<double>(ranks));
    rank = std::clamp(rank, 0, static_cast<Rank>(ranks - 1));  // a guess; corrected exactly below
    while (id < begin(rank)) --rank;
    while (id >= begin(rank + 1)) ++rank;
    return rank;
  }
};

/// Collective. Each row goes to the owner of row.*key; the rows that came here, in no promised order.
template <class Row>
[[nodiscard]] std::vector<Row> scatter(const comm::Comm& comm, const IdBlocks& blocks, std::vector<Row> rows,
                                       GlobalId Row::*key) {
  static_assert(std::is_trivially_copyable_v<Row>);
  std::sort(rows.begin(), rows.end(), [key](const Row& a, const Row& b) { return a.*key < b.*key; });
  std::vector<comm::Parcel> parcels;
  for (std::size_t begin = 0; begin < rows.size();) {
    const Rank to = blocks.owner(rows[begin].*key);
    const GlobalId limit = blocks.begin(to + 1);
    std::size_t end = begin;
    while (end < rows.size() && rows[end].*key < limit) ++end;
    const std::size_t size = (end - begin) * sizeof(Row);
    parcels.push_back({to, std::vector<std::byte>(size)});
    std::memcpy(parcels.back().bytes.data(), &rows[begin], size);
    begin = end;
  }
  rows = {};  // the memory is needed for what comes
  const std::vector<comm::Parcel> incoming = comm::exchange(comm, std::move(parcels));
  std::size_t bytes = 0;
  for (const comm::Parcel& parcel : incoming) bytes += parcel.bytes.size();
  rows.resize(bytes / sizeof(Row));
  std::size_t at = 0;
  for (const comm::Parcel& parcel : incoming) {
    if (parcel.bytes.empty()) continue;
    std::memcpy(rows.data() + at, parcel.bytes.data(), parcel.bytes.size());
    at += parcel.bytes.size() / sizeof(Row);
  }
  return rows;
}

}  // namespace packmpi::output
