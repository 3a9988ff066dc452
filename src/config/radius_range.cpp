#include "config/radius_range.hpp"

#include <algorithm>

#include "config/grading.hpp"

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
    case SizeDistribution::mixture: {
      RadiusRange all = radius_range(radius.parts.front());
      for (const Radius& part : radius.parts) {
        const RadiusRange own = radius_range(part);
        all = {std::min(all.smallest, own.smallest), std::max(all.largest, own.largest)};
      }
      return all;
    }
    default:
      return {radius.min, radius.max};
  }
}

}  // namespace packmpi::input
