#include "mesh/grid.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "mesh/vectors.hpp"

namespace packmpi::mesh {

Grid::Grid(const Shell& shell) {
  const Vec3 size = minus(shell.high, shell.low);
  const double cells = std::clamp(4.0 * static_cast<double>(shell.triangles.size()), 4096.0, 4e6);
  width_ = elementary::cube_root(size[0] * size[1] * size[2] / cells);
  const double largest = *std::ranges::max_element(size);
  width_ = std::max(width_, largest / 4096.0);  // of thin plates
  per_width_ = 1.0 / width_;
  std::int64_t all = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    count_[a] = static_cast<std::int64_t>(size[a] / width_) + 3;
    low_[a] = shell.low[a] - 0.5 * (static_cast<double>(count_[a]) * width_ - size[a]);
    all *= count_[a];
  }
  start_.assign(static_cast<std::size_t>(all) + 1, 0);
  for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
    cells_of(shell, t, [&](std::int64_t cell) { ++start_[static_cast<std::size_t>(cell) + 1]; });
  }
  for (std::size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  entries_.resize(start_.back());
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
    cells_of(shell, t,
             [&](std::int64_t cell) { entries_[next[static_cast<std::size_t>(cell)]++] = static_cast<int>(t); });
  }
}

Vec3 Grid::middle(std::int64_t cell) const {
  const auto at = split(cell);
  Vec3 x{};
  for (std::size_t a = 0; a < 3; ++a) x[a] = low_[a] + (static_cast<double>(at[a]) + 0.5) * width_;
  return x;
}

// Those that its plane and the box around it meet, a little widened.
template <class See>
void Grid::cells_of(const Shell& shell, std::size_t triangle, See&& see) const {
  const Corners c = shell.corners(triangle);
  const double margin = shell.tolerance;
  std::array<std::int64_t, 3> from{}, to{};
  for (std::size_t a = 0; a < 3; ++a) {
    from[a] = step(std::min({c[0][a], c[1][a], c[2][a]}) - margin, a);
    to[a] = step(std::max({c[0][a], c[1][a], c[2][a]}) + margin, a);
  }
  const Vec3 n = unit(shell.normal(triangle));
  const double reach = 0.5 * width_ * (std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2])) + margin;
  for (std::int64_t z = from[2]; z <= to[2]; ++z) {
    for (std::int64_t y = from[1]; y <= to[1]; ++y) {
      for (std::int64_t x = from[0]; x <= to[0]; ++x) {
        const std::int64_t cell = join({x, y, z});
        if (std::abs(dot(n, minus(middle(cell), c[0]))) <= reach) see(cell);
      }
    }
  }
}

void Grid::in_box(const Vec3& low, const Vec3& high, std::vector<int>& found) const {
  found.clear();
  std::array<std::int64_t, 3> from{}, to{};
  for (std::size_t a = 0; a < 3; ++a) from[a] = step(low[a], a), to[a] = step(high[a], a);
  std::size_t cells = 0;
  for (std::int64_t z = from[2]; z <= to[2]; ++z) {
    for (std::int64_t y = from[1]; y <= to[1]; ++y) {
      const std::int64_t row = join({0, y, z});
      const auto begin = start_[static_cast<std::size_t>(row + from[0])];
      const auto end = start_[static_cast<std::size_t>(row + to[0]) + 1];
      if (begin == end) continue;
      found.insert(found.end(), entries_.begin() + begin, entries_.begin() + end);
      cells += static_cast<std::size_t>(to[0] - from[0] + 1);
    }
  }
  if (cells < 2) return;
  std::ranges::sort(found);
  found.erase(std::unique(found.begin(), found.end()), found.end());
}

}  // namespace packmpi::mesh
