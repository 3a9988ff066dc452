/// Between what radii a size distribution lies.
#pragma once
#include "config/input.hpp"

namespace packmpi::input {

/// Radii of more than this ratio are searched for by size (doc/performance.md, "Wide gradings"), and heeded in the
/// step.
constexpr double alike_ratio = 2.5;

/// The smallest and the largest radius [m].
struct RadiusRange {
  double smallest, largest;
};

/// Of a distribution as truncated. Only of one that check_radii() has passed.
[[nodiscard]] RadiusRange radius_range(const Radius& radius);

}  // namespace packmpi::input
