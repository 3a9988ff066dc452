/// The part of a sphere that lies inside a box or inside another sphere.
#pragma once
#include "base/types.hpp"

namespace packmpi::geometry {

/// [m3] of a sphere of radius `r` whose centre is `b` away from that of a sphere of radius `around` (all [m]). In
/// closed form.
[[nodiscard]] double volume_in_sphere(double r, double b, double around) noexcept;

/// [m3] of a sphere of radius `r` in the box from `low` to `high`, both seen from its centre [m]; infinite ones are
/// allowed. Horizontal sections are discs cut by a rectangle, whose area is exact; they are summed piece by piece by
/// Gauss' rule of 24 points. Error below 1e-9 r^3 (tests/geometry/cut_volume.cpp).
[[nodiscard]] double volume_in_box(double r, const Vec3& low, const Vec3& high) noexcept;

/// [m2] of a disc the part in a rectangle of x and y, the same in 2D. In closed form.
[[nodiscard]] double area_in_rectangle(double r, const Vec3& low, const Vec3& high) noexcept;

}  // namespace packmpi::geometry
