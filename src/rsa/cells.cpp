#include "rsa/cells.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"

namespace packmpi::rsa {
namespace {

// About four cells a particle where the layer is thin on particles; they need not be flatter than the layer is thick.
double cell_width(const scene::Scene& scene, const LayerRegion& region, std::int64_t asked, double diameter) {
  const double floor = scene.container.mean_area(region.bottom, region.thickness) /
                       static_cast<double>(4 * std::max<std::int64_t>(asked, 1));
  const double share = floor * region.thickness;
  const bool deep = scene.container.dimension == 3;
  double width = deep ? elementary::cube_root(share) : std::sqrt(share);
  if (width > region.thickness) width = deep ? std::sqrt(floor) : floor;  // one cell high
  return std::max(diameter, width);
}

}  // namespace

CellGrid::CellGrid(const scene::Scene& scene, const scene::Ownership& ownership, const LayerRegion& region,
                   std::int64_t asked, double diameter)
    : lateral_(scene.container.lateral_axes()) {
  const double width = cell_width(scene, region, asked, diameter * (1.0 + slack));
  const double margin = (2.0 * scene.sizes.largest() + scene.in.layers.gap) * (1.0 + slack);
  for (int axis = 0; axis < lateral_; ++axis) {
    axes_[static_cast<std::size_t>(axis)] =
        scene::lateral_axis(ownership, static_cast<std::size_t>(axis), width, margin);
  }
  vertical_axis_.origin = region.bottom;
  vertical_axis_.total = vertical_axis_.count = std::max(1, static_cast<int>(region.thickness / width));
  vertical_axis_.inverse = vertical_axis_.total / region.thickness;
}

CellGrids::CellGrids(const scene::Scene& scene, const scene::Ownership& ownership, const LayerRegion& region,
                     std::int64_t asked) {
  constexpr int classes_a_level = 2;
  const int classes = wide_classes(scene.sizes) ? size_classes : 1;
  for (int k = 0; k < classes; k += classes_a_level) {
    largest_.push_back(class_bound(scene.sizes, k));
    grids_.emplace_back(scene, ownership, region, asked, 2.0 * largest_.back() + scene.in.layers.gap);
  }
}

}  // namespace packmpi::rsa
