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

template <class Row, class What>
void for_each_row(const std::vector<comm::Parcel>& parcels, What&& what) {
  for (const comm::Parcel& parcel : parcels) {
    for (std::size_t at = 0; at < parcel.bytes.size(); at += sizeof(Row)) {
      Row row;
      std::memcpy(&row, parcel.bytes.data() + at, sizeof(Row));
      what(row);
    }
  }
}

/// The row with key `begin` + k into rows[k]. False if a key came twice; all must be of begin .. begin + rows.size()
/// - 1.
template <class Row>
[[nodiscard]] bool place_by_key(const std::vector<comm::Parcel>& parcels, GlobalId begin, GlobalId Row::*key,
                                std::vector<Row>& rows) {
  std::vector<bool> there(rows.size());
  bool once = true;
  for_each_row<Row>(parcels, [&](const Row& row) {
    const auto k = static_cast<std::size_t>(row.*key - begin);
    once = once && !there[k];
    there[k] = true;
    rows[k] = row;
  });
  return once;
}

/// Collective. Each row goes to the owner of row.*key; the rows that came here, by that key (equal keys in no promised
/// order). Cost: O(rows) if every key of this rank's block came once, else they are sorted.
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
  const std::vector<comm::Parcel> incoming = comm::exchange(comm, std::move(parcels), comm::Purpose::output);
  std::size_t bytes = 0;
  for (const comm::Parcel& parcel : incoming) bytes += parcel.bytes.size();
  rows.resize(bytes / sizeof(Row));
  const GlobalId begin = blocks.begin(comm.rank());
  if (static_cast<GlobalId>(rows.size()) == blocks.begin(comm.rank() + 1) - begin &&
      place_by_key(incoming, begin, key, rows)) {
    return rows;
  }
  std::size_t at = 0;
  for_each_row<Row>(incoming, [&](const Row& row) { rows[at++] = row; });
  std::sort(rows.begin(), rows.end(), [key](const Row& a, const Row& b) { return a.*key < b.*key; });
  return rows;
}

}  // namespace packmpi::output
