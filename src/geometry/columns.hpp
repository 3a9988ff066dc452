/// The lateral grid of columns that ownership, halos and neighbour search share.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "geometry/container.hpp"

namespace packmpi::geometry {

using ColumnIndex = std::int64_t;  ///< ix + nx * iy, global

/// nx x ny equal columns (2D: ny = 1), each at least `reach` wide on every axis that has more than one.
/// Border columns at walls reach outwards without end: a particle pressed into a wall belongs to the border column.
/// A periodic axis has at least three columns or its box is refused (scene), so that an image is met once.
class ColumnGrid {
 public:
  ColumnGrid() = default;
  /// At most `most` columns in all, wider ones where they would be more; but a periodic axis keeps three if it has room
  /// for them, and every axis one. Preconditions (asserted): reach > 0, 9 <= most <= 2^30.
  ColumnGrid(const Container& box, double reach, std::int64_t most = std::int64_t{1} << 30);

  /// The same columns, stretched with the periodic axes of a box whose lengths have changed. Every rank alike.
  void stretch(const Container& box);

  [[nodiscard]] const Container& box() const noexcept { return box_; }
  [[nodiscard]] std::array<int, 2> counts() const noexcept { return counts_; }
  [[nodiscard]] std::array<double, 2> widths() const noexcept { return widths_; }  ///< [m]
  [[nodiscard]] ColumnIndex size() const noexcept { return ColumnIndex{counts_[0]} * counts_[1]; }
  /// Column coordinate along `axis`; positions outside the box count as in the border column.
  [[nodiscard]] int coordinate(int axis, double x) const noexcept {
    const auto a = static_cast<std::size_t>(axis);
    const double scaled = x * inverse_widths_[a];
    const double last = counts_[a] - 1;
    return scaled > 0.0 ? static_cast<int>(scaled < last ? scaled : last) : 0;  // NaN: 0
  }
  [[nodiscard]] ColumnIndex column(const Vec3& position) const noexcept {
    return index(coordinate(0, position[0]), box_.dimension == 3 ? coordinate(1, position[1]) : 0);
  }
  [[nodiscard]] ColumnIndex index(int ix, int iy) const noexcept { return ix + ColumnIndex{counts_[0]} * iy; }
  /// Sets `out` to the up to 8 columns that touch `column` (2 in 2D), through periodic faces too, each once, ascending;
  /// not itself.
  void neighbors(ColumnIndex column, std::vector<ColumnIndex>& out) const;
  /// Lateral distance from a position to the rectangle of `column`, through periodic faces [m]; 0 for all whose column
  /// it is. Border columns at walls have no outer edge. Rounded: a halo takes a hair (1e-12 of its reach) more.
  [[nodiscard]] double distance(const Vec3& position, ColumnIndex column) const noexcept;

 private:
  [[nodiscard]] double axis_distance(std::size_t axis, double x, int coordinate_of_column) const noexcept;

  Container box_;
  std::array<int, 2> counts_{1, 1};
  std::array<double, 2> widths_{};
  std::array<double, 2> inverse_widths_{};
};

}  // namespace packmpi::geometry
