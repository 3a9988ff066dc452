/// Which triangles are near: a uniform grid of cubic cells around a surface.
#pragma once
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
  /// The same, for some more than once, calling see(triangle) until that says true: is there such a one?
  template <class See>
  [[nodiscard]] bool any_in_box(const Vec3& low, const Vec3& high, See&& see) const {
    std::array<std::int64_t, 3> from{}, to{};
    for (std::size_t a = 0; a < 3; ++a) from[a] = step(low[a], a), to[a] = step(high[a], a);
    for (std::int64_t z = from[2]; z <= to[2]; ++z) {
      for (std::int64_t y = from[1]; y <= to[1]; ++y) {
        const std::int64_t row = join({0, y, z});
        const auto end = start_[static_cast<std::size_t>(row + to[0]) + 1];
        for (auto k = start_[static_cast<std::size_t>(row + from[0])]; k < end; ++k) {
          if (see(entries_[k])) return true;
        }
      }
    }
    return false;
  }
  template <class See>
  void each_in_box(const Vec3& low, const Vec3& high, See&& see) const {
    (void)any_in_box(low, high, [&](int triangle) { return see(triangle), false; });
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
  [[nodiscard]] std::int64_t cell_of(const Vec3& x) const;  ///< of points beyond, the nearest
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
  [[nodiscard]] std::int64_t step(double x, std::size_t axis) const;
  [[nodiscard]] std::int64_t join(const std::array<std::int64_t, 3>& at) const {
    return at[0] + count_[0] * (at[1] + count_[1] * at[2]);
  }
  [[nodiscard]] std::array<std::int64_t, 3> split(std::int64_t cell) const {
    return {cell % count_[0], cell / count_[0] % count_[1], cell / (count_[0] * count_[1])};
  }
  template <class See>
  void cells_of(const Shell& shell, std::size_t triangle, See&& see) const;

  Vec3 low_{};
  double width_ = 1.0;
  std::array<std::int64_t, 3> count_{1, 1, 1};
  std::vector<std::uint32_t> start_;  // of each cell in entries_
  std::vector<int> entries_;
};

}  // namespace packmpi::mesh
