/// Which triangles are near: a uniform grid of cubic cells around a surface.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "mesh/shell.hpp"

namespace packmpi::mesh {

/// Cells of the box around a surface and one more on each side. Local.
class Grid {
 public:
  Grid() = default;
  explicit Grid(const Shell& shell);

  /// Triangles of the cells that meet the box from `low` to `high`, each once, in ascending order: all that reach into
  /// it, and others.
  void in_box(const Vec3& low, const Vec3& high, std::vector<int>& found) const;
  /// Calls see(triangle), for some more than once, until that says true, for all that the cells have that a ball of
  /// radius `r` [m] meets, and others: is there such a one?
  template <class See>
  [[nodiscard]] bool any_in_ball(const Vec3& x, double r, See&& see) const {
    std::array<std::int64_t, 3> from{}, to{};
    for (std::size_t a = 1; a < 3; ++a) from[a] = step(x[a] - r, a), to[a] = step(x[a] + r, a);
    for (std::int64_t z = from[2]; z <= to[2]; ++z) {
      const double over = away(x[2], z, 2), slice = wider * (r * r) - over * over;
      for (std::int64_t y = from[1]; y <= to[1]; ++y) {
        const double beside = away(x[1], y, 1), square = slice - beside * beside;
        if (!(square >= 0.0)) continue;
        const double half = std::sqrt(square);
        if (any_in_row(join({0, y, z}), step(x[0] - half, 0), step(x[0] + half, 0), see)) return true;
      }
    }
    return false;
  }
  template <class See>
  void each_in_ball(const Vec3& x, double r, See&& see) const {
    (void)any_in_ball(x, r, [&](int triangle) { return see(triangle), false; });
  }
  /// Calls see(first, last) for each cell with its triangles.
  template <class See>
  void each_cell(See&& see) const {
    for (std::size_t c = 0; c + 1 < start_.size(); ++c) {
      if (start_[c] < start_[c + 1]) see(entries_.data() + start_[c], entries_.data() + start_[c + 1]);
    }
  }
  [[nodiscard]] std::int64_t cells() const { return static_cast<std::int64_t>(start_.size()) - 1; }
  [[nodiscard]] bool is_empty(std::int64_t cell) const {
    return start_[static_cast<std::size_t>(cell)] == start_[static_cast<std::size_t>(cell) + 1];
  }
  /// Of points beyond, the nearest.
  [[nodiscard]] std::int64_t cell_of(const Vec3& x) const {
    return join({step(x[0], 0), step(x[1], 1), step(x[2], 2)});
  }
  [[nodiscard]] Vec3 middle(std::int64_t cell) const;
  [[nodiscard]] double width() const { return width_; }  ///< [m] of a cell
  /// Calls see(cell) for the up to 26 cells around one, or the six that share a side with it.
  template <class See>
  void around(std::int64_t cell, bool sides_only, See&& see) const {
    const std::array<std::int64_t, 3> at = split(cell);
    for (std::int64_t z = -1; z <= 1; ++z) {
      for (std::int64_t y = -1; y <= 1; ++y) {
        for (std::int64_t x = -1; x <= 1; ++x) {
          const std::int64_t steps = x * x + y * y + z * z;
          if (steps == 0 || (sides_only && steps > 1)) continue;
          const std::array<std::int64_t, 3> to{at[0] + x, at[1] + y, at[2] + z};
          bool inside = true;
          for (std::size_t a = 0; a < 3; ++a) inside = inside && to[a] >= 0 && to[a] < count_[a];
          if (inside) see(join(to));
        }
      }
    }
  }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return start_.capacity() * sizeof(std::uint32_t) + entries_.capacity() * sizeof(int);
  }

 private:
  static constexpr double wider = 1.0 + 1e-9;  // for the sake of rounding

  [[nodiscard]] std::int64_t step(double x, std::size_t axis) const {
    const double place = (x - low_[axis]) * per_width_;
    if (!(place > 0.0)) return 0;
    return std::min(static_cast<std::int64_t>(std::min(place, 1e9)), count_[axis] - 1);
  }
  /// [m] from a coordinate to the cells of one number; those at the ends have all that is beyond them.
  [[nodiscard]] double away(double x, std::int64_t number, std::size_t axis) const {
    const double low = low_[axis] + static_cast<double>(number) * width_, high = low + width_;
    return std::max({0.0, number > 0 ? low - x : 0.0, number + 1 < count_[axis] ? x - high : 0.0}) * (1.0 - 1e-9);
  }
  template <class See>
  [[nodiscard]] bool any_in_row(std::int64_t row, std::int64_t from, std::int64_t to, See&& see) const {
    const auto end = start_[static_cast<std::size_t>(row + to) + 1];
    for (auto k = start_[static_cast<std::size_t>(row + from)]; k < end; ++k) {
      if (see(entries_[k])) return true;
    }
    return false;
  }
  [[nodiscard]] std::int64_t join(const std::array<std::int64_t, 3>& at) const {
    return at[0] + count_[0] * (at[1] + count_[1] * at[2]);
  }
  [[nodiscard]] std::array<std::int64_t, 3> split(std::int64_t cell) const {
    return {cell % count_[0], cell / count_[0] % count_[1], cell / (count_[0] * count_[1])};
  }
  template <class See>
  void cells_of(const Shell& shell, std::size_t triangle, See&& see) const;

  Vec3 low_{};
  double width_ = 1.0, per_width_ = 1.0;
  std::array<std::int64_t, 3> count_{1, 1, 1};
  std::vector<std::uint32_t> start_;  // of each cell in entries_
  std::vector<int> entries_;
};

}  // namespace packmpi::mesh
