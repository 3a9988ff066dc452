#include "geometry/columns.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace packmpi::geometry {
namespace {

constexpr double countable = 1 << 30;  // columns an axis

/// The largest n with length / n >= reach as doubles divide, at least 1.
int columns_along(double length, double reach) {
  const double fitting = std::floor(length / reach);
  assert(fitting <= countable);
  int n = std::max(1, static_cast<int>(fitting));
  while (n > 1 && length / n < reach) --n;
  return n;
}

/// The widths that columns must have at least so that there are no more than `most`: `reach`, unless they would be.
std::array<double, 2> least_widths(const Container& box, double reach, std::int64_t most) {
  std::array<double, 2> least{reach, reach};
  const auto lateral = static_cast<std::size_t>(box.lateral_axes());
  const auto columns = [&] {
    double all = 1.0;
    for (std::size_t a = 0; a < lateral; ++a) all *= std::max(1.0, std::floor(box.size[a] / least[a]));
    return all;
  };
  const auto bound = static_cast<double>(most);
  double width = reach;
  for (double all = columns(); all > bound; all = columns()) {  // ends: each turn shrinks the excess, by 1 % at least
    width *= std::max(1.01, lateral == 2 ? std::sqrt(all / bound) : all / bound);
    for (std::size_t a = 0; a < lateral; ++a) {
      const double widest = box.periodic[a] ? box.size[a] / 3.0 * (1.0 - 1e-12) : box.size[a];  // three fit, rounded
      least[a] = std::max(reach, std::min(width, widest));
    }
  }
  return least;
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

ColumnGrid::ColumnGrid(const Container& box, double reach, std::int64_t most) : box_(box) {
  assert(reach > 0.0 && most >= 9 && static_cast<double>(most) <= countable);
  const std::array<double, 2> least = least_widths(box, reach, most);
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(box.lateral_axes()); ++axis) {
    counts_[axis] = columns_along(box.size[axis], least[axis]);
    widths_[axis] = box.size[axis] / counts_[axis];
    inverse_widths_[axis] = counts_[axis] / box.size[axis];
  }
}

void ColumnGrid::stretch(const Container& box) {
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(box.lateral_axes()); ++axis) {
    if (!box.periodic[axis]) continue;
    box_.size[axis] = box.size[axis];
    widths_[axis] = box.size[axis] / counts_[axis];
    inverse_widths_[axis] = 1.0 / widths_[axis];
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
