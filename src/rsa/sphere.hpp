/// Spheres as this module passes them around, and the one test for their overlap.
#pragma once
#include <array>
#include <compare>
#include <cstdint>
#include <limits>

#include "base/types.hpp"
#include "geometry/container.hpp"

namespace packmpi::rsa {

/// Reaches and cells are widened by this share of a diameter, so that rounding cannot hide an overlap. Changes no
/// result.
inline constexpr double slack = 1e-9;

/// A sphere, or in 2D a disc with z = 0. [m]
struct Sphere {
  Vec3 centre;
  double radius;
};

/// A sphere thrown for a particle of the layer.
struct Trial {
  std::uint64_t particle;
  std::uint32_t attempt;
  Sphere sphere;
};

/// The order of the serial loop: every particle's first trial, then the second trials of those left, and so on.
struct Turn {
  std::uint32_t attempt;
  std::uint64_t particle;
  friend constexpr auto operator<=>(const Turn&, const Turn&) = default;
};
[[nodiscard]] constexpr Turn turn(const Trial& trial) { return {trial.attempt, trial.particle}; }

/// Distances in a box, prepared for hot loops: a wall axis has an infinite period.
class Metric {
 public:
  /// Spheres are to be `gap` [m] apart.
  explicit Metric(const geometry::Container& box, double gap = 0.0) : gap_(gap) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      if (box.periodic[axis]) period_[axis] = box.size[axis];
    }
  }

  /// True if the spheres have a point inside both, or are nearer than the gap; spheres that touch do not overlap. Both
  /// centres wrapped.
  [[nodiscard]] bool overlap(const Sphere& a, const Sphere& b) const noexcept {
    const double x = geometry::shortest(a.centre[0] - b.centre[0], period_[0]);
    const double y = geometry::shortest(a.centre[1] - b.centre[1], period_[1]);
    const double z = a.centre[2] - b.centre[2];
    const double reach = a.radius + b.radius + gap_;
    return x * x + y * y + z * z < reach * reach;
  }

 private:
  double gap_;
  std::array<double, 2> period_{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
};

}  // namespace packmpi::rsa
