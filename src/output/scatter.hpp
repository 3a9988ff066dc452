/// Rows to the rank that writes them: each rank owns one contiguous block of ids. Private to this room.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <type_traits>
#include <utility>
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

/// Collective. Each row goes to the owner of row.*key; the rows that came here, in no promised order. Cost: O(rows).
template <class Row>
[[nodiscard]] std::vector<Row> scatter(const comm::Comm& comm, const IdBlocks& blocks, std::vector<Row> rows,
                                       GlobalId Row::*key) {
  static_assert(std::is_trivially_copyable_v<Row>);
  std::map<Rank, std::size_t> counts;
  for (const Row& row : rows) ++counts[blocks.owner(row.*key)];
  std::vector<comm::Parcel> parcels;
  std::map<Rank, std::byte*> next;
  for (const auto& [to, count] : counts) {
    parcels.push_back({to, std::vector<std::byte>(count * sizeof(Row))});
    next[to] = parcels.back().bytes.data();
  }
  for (const Row& row : rows) {
    std::byte*& place = next[blocks.owner(row.*key)];
    std::memcpy(place, &row, sizeof(Row));
    place += sizeof(Row);
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

/// Local. Puts the row with key `begin` + k into place k, in place. False if a key is there twice or none of
/// begin .. begin + rows.size() - 1; then the rows are in no particular order. Cost: O(rows).
template <class Row>
[[nodiscard]] bool put_in_order(std::vector<Row>& rows, GlobalId begin, GlobalId Row::*key) {
  const auto place = [&](std::size_t k) { return rows[k].*key - begin; };
  for (std::size_t k = 0; k < rows.size(); ++k) {
    while (place(k) != static_cast<GlobalId>(k)) {
      const GlobalId to = place(k);
      if (to < 0 || to >= static_cast<GlobalId>(rows.size()) || place(static_cast<std::size_t>(to)) == to) return false;
      std::swap(rows[k], rows[static_cast<std::size_t>(to)]);
    }
  }
  return true;
}

}  // namespace packmpi::output
