/// Splitting weighted columns into parts; serial and deterministic, the same answer on every rank.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/types.hpp"

namespace packmpi::scene {

/// Cut a line of weighted cells into `parts` runs of at least one cell with nearly equal weight. Returns parts + 1
/// first indices, the last one the number of cells. Precondition: 1 <= parts <= weights.size(). Cost: O(cells + parts).
[[nodiscard]] std::vector<int> cut_line(std::span<const std::int64_t> weights, int parts);

/// Px x Py = ranks with Px <= nx and Py <= ny and the smallest halo (perimeter of a part); none if there is no such
/// pair.
struct Factors {
  int x, y;
};
[[nodiscard]] std::optional<Factors> factor_ranks(int ranks, int nx, int ny, double length_x, double length_y);

/// A grid of weighted tiles for METIS.
struct TileGrid {
  int nx, ny;
  bool periodic_x, periodic_y;
  std::vector<std::int64_t> weights;  ///< nx * ny, x fastest
};
/// Part of each tile, from METIS recursive bisection, every part non-empty; if METIS leaves one empty, a weighted snake
/// through the grid instead. Precondition: 1 <= parts <= nx * ny.
[[nodiscard]] std::vector<Rank> partition_tiles(const TileGrid& grid, int parts);

}  // namespace packmpi::scene
