#include "input/radius_range.hpp"

#include <algorithm>

#include "input/grading.hpp"

namespace packmpi::input {

RadiusRange radius_range(const Radius& radius) {
  switch (radius.distribution) {
    case SizeDistribution::equal:
      return {radius.value, radius.value};
    case SizeDistribution::bidisperse:
      return {radius.small, radius.large};
    case SizeDistribution::discrete:
      return {radius.radii.front(), radius.radii.back()};
    case SizeDistribution::list: {
      const auto [smallest, largest] = std::ranges::minmax(radius.radii);
      return {smallest, largest};
    }
    case SizeDistribution::grading: {
      const Curve curve = kept_curve(radius);
      return {0.5 * curve.front()[0], 0.5 * curve.back()[0]};
    }
    default:
      return {radius.min, radius.max};
  }
}

}  // namespace packmpi::input
