#include "geometry/columns.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace packmpi::geometry {
namespace {

/// The largest n with length / n >= reach as doubles divide, at least 1.
int columns_along(double length, double reach) {
  const double fitting = std::floor(length / reach);
  assert(fitting <= double{1 << 30});
  int n = std::max(1, static_cast<int>(fitting));
  while (n > 1 && length / n < reach) --n;
  return n;
}

/// The coordinates next to c along an axis of n columns, c among them.
std::vector<int> around(int c, int n, bool periodic) {
  std::vector<int> near;
  for (int other = c - 1; other <= c + 1; ++other) {
    if (periodic) {
      near.push_back((other + n) % n);
    } else if (other >= 0 && other < n) {
      near.push_back(other);
    }
  }
  return near;
}

}  // namespace

ColumnGrid::ColumnGrid(const Box& box, double reach) : box_(box) {
  assert(reach > 0.0);
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(box.lateral_axes()); ++axis) {
    counts_[axis] = columns_along(box.size[axis], reach);
    widths_[axis] = box.size[axis] / counts_[axis];
    inverse_widths_[axis] = counts_[axis] / box.size[axis];
  }
}

void ColumnGrid::neighbors(ColumnIndex column, std::vector<ColumnIndex>& out) const {
  assert(column >= 0 && column < size());
  const bool periodic_y = box_.dimension == 3 && box_.periodic[1];
  out.clear();
  for (const int iy : around(static_cast<int>(column / counts_[0]), counts_[1], periodic_y)) {
    for (const int ix : around(static_cast<int>(column % counts_[0]), counts_[0], box_.periodic[0])) {
      if (index(ix, iy) != column) out.push_back(index(ix, iy));
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());  // one or two periodic columns meet twice
}

double ColumnGrid::axis_distance(std::size_t axis, double x, int coordinate_of_column) const noexcept {
  if (coordinate(static_cast<int>(axis), x) == coordinate_of_column)
    return 0.0;  // the edges as coordinate() rounds them
  const double length = box_.size[axis];
  const double low = coordinate_of_column * widths_[axis];
  const double high = low + widths_[axis];
  const auto to_column = [&](double image) { return std::max({low - image, image - high, 0.0}); };
  if (!box_.periodic[axis]) return to_column(std::clamp(x, 0.0, length));
  return std::min({to_column(x), to_column(x - length), to_column(x + length)});
}

double ColumnGrid::distance(const Vec3& position, ColumnIndex column) const noexcept {
  const double dx = axis_distance(0, position[0], static_cast<int>(column % counts_[0]));
  if (box_.dimension == 2) return dx;
  const double dy = axis_distance(1, position[1], static_cast<int>(column / counts_[0]));
  return std::sqrt(dx * dx + dy * dy);
}

}  // namespace packmpi::geometry
