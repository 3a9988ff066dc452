/// Rows to the rank that writes them: each rank owns one contiguous block of ids. Private to this module.
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

namespace packmpi::disk {

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

/// Rows that stayed here, then those that came.
template <class Row, class What>
void for_each_row(const std::vector<Row>& own, const std::vector<comm::Parcel>& parcels, What&& what) {
  for (const Row& row : own) what(row);
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
[[nodiscard]] bool place_by_key(const std::vector<Row>& own, const std::vector<comm::Parcel>& parcels, GlobalId begin,
                                GlobalId Row::*key, std::vector<Row>& rows) {
  std::vector<bool> there(rows.size());
  bool once = true;
  for_each_row(own, parcels, [&](const Row& row) {
    const auto k = static_cast<std::size_t>(row.*key - begin);
    once = once && !there[k];
    there[k] = true;
    rows[k] = row;
  });
  return once;
}

/// Takes the rows that others write out of `rows`, a parcel for each of them.
template <class Row>
[[nodiscard]] std::vector<comm::Parcel> take_foreign(Rank me, const IdBlocks& blocks, std::vector<Row>& rows,
                                                     GlobalId Row::*key) {
  std::map<Rank, std::size_t> counts;
  for (const Row& row : rows) {
    if (const Rank to = blocks.owner(row.*key); to != me) ++counts[to];
  }
  std::vector<comm::Parcel> parcels;
  std::map<Rank, std::byte*> next;
  for (const auto& [to, count] : counts) {
    parcels.push_back({to, std::vector<std::byte>(count * sizeof(Row))});
    next[to] = parcels.back().bytes.data();
  }
  if (parcels.empty()) return parcels;
  const auto foreign = [&](const Row& row) {
    const Rank to = blocks.owner(row.*key);
    if (to == me) return false;
    std::byte*& place = next[to];
    std::memcpy(place, &row, sizeof(Row));
    place += sizeof(Row);
    return true;
  };
  std::erase_if(rows, foreign);
  return parcels;
}

/// Collective. Each row goes to the owner of row.*key; the rows that came here, by that key (equal keys in no promised
/// order). Cost: O(rows) if every key of this rank's block came once, else they are sorted.
template <class Row>
[[nodiscard]] std::vector<Row> scatter(const comm::Comm& comm, const IdBlocks& blocks, std::vector<Row> rows,
                                       GlobalId Row::*key) {
  static_assert(std::is_trivially_copyable_v<Row>);
  const std::vector<comm::Parcel> incoming =
      comm::exchange(comm, take_foreign(comm.rank(), blocks, rows, key), comm::Purpose::output);
  std::size_t count = rows.size();
  for (const comm::Parcel& parcel : incoming) count += parcel.bytes.size() / sizeof(Row);
  std::vector<Row> all(count);
  const GlobalId begin = blocks.begin(comm.rank());
  if (static_cast<GlobalId>(count) == blocks.begin(comm.rank() + 1) - begin &&
      place_by_key(rows, incoming, begin, key, all)) {
    return all;
  }
  std::size_t at = 0;
  for_each_row(rows, incoming, [&](const Row& row) { all[at++] = row; });
  std::sort(all.begin(), all.end(), [key](const Row& a, const Row& b) { return a.*key < b.*key; });
  return all;
}

}  // namespace packmpi::disk
