#include "rsa/cells.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace packmpi::rsa {
namespace {

// The shortest run of column coordinates that holds all that are used: first and number. On a periodic axis the run may
// pass through the end.
std::pair<int, int> shortest_run(const std::vector<char>& used, bool periodic) {
  const auto n = static_cast<int>(used.size());
  const auto at = [&](int k) { return used[static_cast<std::size_t>(k % n)] != 0; };
  int low = 0;
  while (low < n && !at(low)) ++low;
  if (low == n) return {0, 0};
  int high = n - 1;
  while (!at(high)) --high;
  if (!periodic) return {low, high - low + 1};
  int gap_end = low + n, gap = low + n - high - 1;  // the gap through the end, then those between
  for (int k = low, last = low; k <= high; ++k) {
    if (!at(k)) continue;
    if (k - last - 1 > gap) {
      gap = k - last - 1;
      gap_end = k;
    }
    last = k;
  }
  return {gap_end % n, n - gap};
}

std::vector<char> used_coordinates(const scene::Ownership& ownership, std::size_t axis) {
  const auto counts = ownership.grid().counts();
  std::vector<char> used(static_cast<std::size_t>(counts[axis]), 0);
  for (const geometry::ColumnIndex column : ownership.columns()) {
    used[static_cast<std::size_t>(axis == 0 ? column % counts[0] : column / counts[0])] = 1;
  }
  return used;
}

int cells_along(double length, double width) { return std::max(1, static_cast<int>(length / width)); }

// Cells under the run of this rank's columns and one diameter further on both sides.
CellAxis lateral_axis(const scene::Ownership& ownership, std::size_t axis, double width, double diameter) {
  const geometry::Box& box = ownership.grid().box();
  const double column = ownership.grid().widths()[axis];
  const auto [first_column, columns] = shortest_run(used_coordinates(ownership, axis), box.periodic[axis]);
  CellAxis cells;
  cells.total = cells_along(box.size[axis], width);
  cells.inverse = cells.total / box.size[axis];
  auto low = static_cast<int>(std::floor((first_column * column - diameter) * cells.inverse));
  auto high = static_cast<int>(std::floor(((first_column + columns) * column + diameter) * cells.inverse));
  if (!box.periodic[axis]) {
    low = std::max(low, 0);
    high = std::min(high, cells.total - 1);
  } else if (high - low + 1 >= cells.total) {
    cells.closed = true;
    low = 0;
    high = cells.total - 1;
  }
  cells.first = (low + cells.total) % cells.total;
  cells.count = high - low + 1;
  return cells;
}

// About four cells a particle where the layer is thin on particles.
double cell_width(const scene::Scene& scene, const LayerRegion& region, std::int64_t asked) {
  const double share =
      scene.box.floor_area() * region.thickness / static_cast<double>(4 * std::max<std::int64_t>(asked, 1));
  return std::max(2.0 * scene.sizes.largest() * (1.0 + slack),
                  scene.box.dimension == 3 ? std::cbrt(share) : std::sqrt(share));
}

}  // namespace

CellGrid::CellGrid(const scene::Scene& scene, const scene::Ownership& ownership, const LayerRegion& region,
                   std::int64_t asked)
    : lateral_(scene.box.lateral_axes()) {
  const double width = cell_width(scene, region, asked);
  const double diameter = 2.0 * scene.sizes.largest() * (1.0 + slack);
  for (int axis = 0; axis < lateral_; ++axis) {
    axes_[static_cast<std::size_t>(axis)] = lateral_axis(ownership, static_cast<std::size_t>(axis), width, diameter);
  }
  vertical_axis_.origin = region.bottom;
  vertical_axis_.total = vertical_axis_.count = cells_along(region.thickness, width);
  vertical_axis_.inverse = vertical_axis_.total / region.thickness;
}

}  // namespace packmpi::rsa
