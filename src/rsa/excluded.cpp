#include "rsa/excluded.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"

namespace packmpi::rsa {
namespace {

constexpr double finest = 5.0;         // voxels in a reach: more find little more
constexpr double most_voxels = 100.0;  // a particle
constexpr double inside = 1.0 - 1e-6;  // of a reach: rounding of places moves no point out of it

double voxel_width(const scene::Scene& scene, const LayerRegion& region, std::int64_t asked) {
  const double reach = 2.0 * scene.sizes.smallest() + scene.in.layers.gap;
  const double share = scene.container.mean_area(region.bottom, region.thickness) * region.thickness /
                       (most_voxels * static_cast<double>(std::max<std::int64_t>(asked, 1)));
  return std::max(reach / finest, scene.container.dimension == 3 ? elementary::cube_root(share) : std::sqrt(share));
}

/// The largest whole number not above x, which is more than -2^20; without a call.
int below(double x) noexcept { return static_cast<int>(x + 0x1p20) - 0x100000; }

}  // namespace

Excluded::Excluded(const scene::Scene& scene, const scene::Ownership& ownership, const LayerRegion& region,
                   std::int64_t asked)
    : lateral_(scene.container.lateral_axes()), reach_(scene.sizes.smallest() + scene.in.layers.gap) {
  const double width = voxel_width(scene, region, asked);
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(lateral_); ++axis) {
    axes_[axis] = scene::lateral_axis(ownership, axis, width, width);  // a column may end in a voxel
    periodic_[axis] = scene.container.periodic[axis];
  }
  if (lateral_ == 1) steps_[1] = {{0, 0.0}};
  vertical_.origin = region.bottom;
  vertical_.total = vertical_.count = std::max(1, static_cast<int>(region.thickness / width));
  vertical_.inverse = vertical_.total / region.thickness;
  const auto blocks = [](const scene::CellAxis& axis) { return (axis.count + edge - 1) / edge; };
  rows_ = blocks(axes_[0]), height_ = blocks(vertical_);
  blocks_.assign(
      static_cast<std::size_t>(rows_) * static_cast<std::size_t>(blocks(axes_[1])) * static_cast<std::size_t>(height_),
      0);
}

// Those of this rank, into steps_.
void Excluded::find_steps(std::size_t axis, double centre, double reach) {
  const scene::CellAxis& cells = axes_[axis];
  steps_[axis].clear();
  const double width = 1.0 / cells.inverse;
  const int low = below((centre - reach) * cells.inverse);
  const int high = below((centre + reach) * cells.inverse);
  for (int k = low; k <= high; ++k) {
    if (!periodic_[axis] && (k < 0 || k >= cells.total)) continue;
    const double farther = std::max(centre - k * width, (k + 1) * width - centre);
    const int slot = ((k - cells.first) % cells.total + cells.total) % cells.total;
    if (slot < cells.count) steps_[axis].push_back({slot, farther * farther});
  }
}

void Excluded::add(const Sphere& placed) {
  const double reach = (placed.radius + reach_) * inside;
  find_steps(0, placed.centre[0], reach);
  if (lateral_ == 2) find_steps(1, placed.centre[1], reach);
  const double height = (placed.centre[lateral_ == 2 ? 2 : 1] - vertical_.origin) * vertical_.inverse;
  for (const Step& y : steps_[1]) {
    for (const Step& x : steps_[0]) {
      const double left = reach * reach - x.squared - y.squared;
      if (left <= 0.0) continue;
      const double half = std::sqrt(left) * vertical_.inverse;
      fill(x.slot, y.slot, below(height - half) + 1, below(height + half));
    }
  }
}

// Voxels from `from` to the one before `to`.
void Excluded::fill(int x, int y, int from, int to) noexcept {
  from = std::max(from, 0), to = std::min(to, vertical_.count);
  std::uint64_t* const blocks = blocks_.data() + row(x, y);
  const unsigned first = first_bit(x, y);
  for (int k = from; k < to;) {
    const int end = std::min((k / edge + 1) * edge, to);
    const std::uint64_t ones = (std::uint64_t{1} << static_cast<unsigned>(end - k)) - 1;
    blocks[k / edge] |= ones << (first + static_cast<unsigned>(k % edge));
    k = end;
  }
}

}  // namespace packmpi::rsa
