/// Who owns which column of the lateral grid.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "comm/comm.hpp"
#include "geometry/columns.hpp"
#include "input/input.hpp"

namespace packmpi::scene {

/// The largest number of ranks that the decomposition has columns for, of those of this grid; with "pencil" not every
/// smaller number can be laid out. Local.
[[nodiscard]] std::int64_t most_ranks(const geometry::ColumnGrid& grid, input::Decomposition kind);

/// Throws Error(bad_input) if the decomposition cannot give each of `ranks` ranks columns, with the largest number that
/// can be used. Local.
void check_ranks(const geometry::ColumnGrid& grid, input::Decomposition kind, int ranks);

/// The column -> rank table, whichever way it was filled (slab, pencil, METIS). The halo, migration and RSA see only
/// this. Memory: cut positions for slab and pencil, at most 65,536 tiles of columns for METIS; never O(particles).
class Ownership {
 public:
  /// Collective. Equal shares, in a round vessel of the room there is. Throws on all ranks as check_ranks() does.
  Ownership(const comm::Comm& comm, const geometry::ColumnGrid& grid, input::Decomposition kind);

  /// Collective. Shares of equal weight; `mine` are the weights of the columns this rank owns, in the order of
  /// columns(). True if a new table was taken, which happens only if it lowers the largest share by 5 %. Not in the
  /// step loop: uses an O(ranks) array for the moment of the decision.
  bool rebalance(std::span<const std::int64_t> mine);

  [[nodiscard]] const geometry::ColumnGrid& grid() const noexcept { return grid_; }
  /// See ColumnGrid::stretch(). Every rank alike.
  void stretch(const geometry::Container& box) { grid_.stretch(box); }
  [[nodiscard]] Rank owner(geometry::ColumnIndex column) const noexcept;
  /// The columns of this rank, ascending.
  [[nodiscard]] std::span<const geometry::ColumnIndex> columns() const noexcept { return columns_; }
  /// Which part of the lateral plane is this rank's, counted along x and y; {0, 0} for METIS.
  [[nodiscard]] std::array<int, 2> part() const noexcept;
  /// The ranks, other than this one, that own a column touching one of ours; ascending.
  [[nodiscard]] std::span<const Rank> neighbors() const noexcept { return neighbors_; }

 private:
  /// The table itself, in the form its kind needs.
  struct Table {
    std::vector<int> cuts_x, cuts_y;  // slab, pencil: first column coordinate of each part, ascending, and the end
    std::vector<Rank> tiles;          // METIS: owner of each tile
  };
  [[nodiscard]] std::size_t long_axis() const;     // the longer lateral axis: slabs are cut across it
  [[nodiscard]] std::array<int, 2> tiles() const;  // tiles on each axis
  [[nodiscard]] std::size_t weight_count() const;
  [[nodiscard]] Table cut(std::span<const std::int64_t> weights) const;  // collective for METIS
  [[nodiscard]] Rank owner(const Table& table, geometry::ColumnIndex column) const noexcept;
  [[nodiscard]] bool worth_it(const Table& table, std::span<const std::int64_t> mine) const;  // collective
  [[nodiscard]] std::vector<std::int64_t> room() const;
  void collect();  // columns_ and neighbors_ from the table

  const comm::Comm* comm_;
  geometry::ColumnGrid grid_;
  input::Decomposition kind_;
  int tile_ = 1;  // columns a tile on each axis
  Table table_;
  std::vector<geometry::ColumnIndex> columns_;
  std::vector<Rank> neighbors_;
};

}  // namespace packmpi::scene
