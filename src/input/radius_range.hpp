/// Between what radii a size distribution lies.
#pragma once
#include "input/input.hpp"

namespace packmpi::input {

/// The smallest and the largest radius [m].
struct RadiusRange {
  double smallest, largest;
};

/// Of a distribution as truncated. Only of one that check_radii() has passed.
[[nodiscard]] RadiusRange radius_range(const Radius& radius);

}  // namespace packmpi::input
