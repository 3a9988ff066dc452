#include "scene/cell_axis.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace packmpi::scene {
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

std::vector<char> used_coordinates(const Ownership& ownership, std::size_t axis) {
  const auto counts = ownership.grid().counts();
  std::vector<char> used(static_cast<std::size_t>(counts[axis]), 0);
  for (const geometry::ColumnIndex column : ownership.columns()) {
    used[static_cast<std::size_t>(axis == 0 ? column % counts[0] : column / counts[0])] = 1;
  }
  return used;
}

int cells_along(double length, double width) { return std::max(1, static_cast<int>(length / width)); }

}  // namespace

CellAxis lateral_axis(const Ownership& ownership, std::size_t axis, double width, double margin) {
  const geometry::Container& box = ownership.grid().box();
  const double column = ownership.grid().widths()[axis];
  const auto [first_column, columns] = shortest_run(used_coordinates(ownership, axis), box.periodic[axis]);
  CellAxis cells;
  cells.total = cells_along(box.size[axis], width);
  cells.inverse = cells.total / box.size[axis];
  auto low = static_cast<int>(std::floor((first_column * column - margin) * cells.inverse));
  auto high = static_cast<int>(std::floor(((first_column + columns) * column + margin) * cells.inverse));
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

}  // namespace packmpi::scene
