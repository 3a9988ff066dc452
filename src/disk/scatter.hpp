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

/// Piece `number` of every rank's block: `length` ids of it, fewer at its end.
struct IdPiece {
  IdBlocks blocks;
  std::int64_t length;
  std::int64_t number;

  [[nodiscard]] GlobalId begin(Rank rank) const {
    return std::min(blocks.begin(rank) + number * length, blocks.begin(rank + 1));
  }
  [[nodiscard]] GlobalId end(Rank rank) const {
    return std::min(blocks.begin(rank) + (number + 1) * length, blocks.begin(rank + 1));
  }
  /// Precondition: 0 <= id < total.
  [[nodiscard]] bool has(GlobalId id) const { return (id - blocks.begin(blocks.owner(id))) / length == number; }
};

/// The blocks in pieces of at least `least` ids, so few that looking through all rows for each of them is cheap.
struct IdPieces {
  IdBlocks blocks;
  std::int64_t least;

  [[nodiscard]] std::int64_t length() const {
    constexpr std::int64_t most_pieces = 16;
    const std::int64_t longest = blocks.total / blocks.ranks + 1;
    return std::max(least, (longest + most_pieces - 1) / most_pieces);
  }
  [[nodiscard]] std::int64_t count() const {  // the same on all ranks
    return std::max<std::int64_t>(1, (blocks.total / blocks.ranks + length()) / length());
  }
  [[nodiscard]] IdPiece piece(std::int64_t number) const { return {blocks, length(), number}; }
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

/// Collective. Each row goes to the owner of row.*key, which is in `piece` on all ranks; the rows that came here, by
/// that key (equal keys in no promised order). Cost: O(rows) if every key of this rank's piece came once, else they are
/// sorted.
template <class Row>
[[nodiscard]] std::vector<Row> scatter(const comm::Comm& comm, const IdPiece& piece, std::vector<Row> rows,
                                       GlobalId Row::*key) {
  static_assert(std::is_trivially_copyable_v<Row>);
  const std::vector<comm::Parcel> incoming =
      comm::relay(comm, take_foreign(comm.rank(), piece.blocks, rows, key), comm::Purpose::output);
  std::size_t count = rows.size();
  for (const comm::Parcel& parcel : incoming) count += parcel.bytes.size() / sizeof(Row);
  std::vector<Row> all(count);
  const GlobalId begin = piece.begin(comm.rank());
  if (static_cast<GlobalId>(count) == piece.end(comm.rank()) - begin && place_by_key(rows, incoming, begin, key, all)) {
    return all;
  }
  std::size_t at = 0;
  for_each_row(rows, incoming, [&](const Row& row) { all[at++] = row; });
  std::sort(all.begin(), all.end(), [key](const Row& a, const Row& b) { return a.*key < b.*key; });
  return all;
}

/// The same, of all ids at once.
template <class Row>
[[nodiscard]] std::vector<Row> scatter(const comm::Comm& comm, const IdBlocks& blocks, std::vector<Row> rows,
                                       GlobalId Row::*key) {
  return scatter(comm, IdPiece{blocks, std::max<std::int64_t>(1, blocks.total), 0}, std::move(rows), key);
}

/// Collective. How many rows this rank is going to write, of counts[r] that each rank has for rank r.
[[nodiscard]] inline std::int64_t count_incoming(const comm::Comm& comm, const std::map<Rank, std::int64_t>& counts) {
  std::vector<comm::Parcel> parcels;
  parcels.reserve(counts.size());
  for (const auto& [to, count] : counts) {
    parcels.push_back({to, std::vector<std::byte>(sizeof count)});
    std::memcpy(parcels.back().bytes.data(), &count, sizeof count);
  }
  std::int64_t all = 0;
  for (const comm::Parcel& parcel : comm::relay(comm, std::move(parcels), comm::Purpose::output)) {
    std::int64_t count = 0;
    std::memcpy(&count, parcel.bytes.data(), sizeof count);
    all += count;
  }
  return all;
}

}  // namespace packmpi::disk
