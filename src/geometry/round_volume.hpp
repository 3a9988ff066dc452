/// The part of a sphere that lies inside a round vessel, between two heights.
#pragma once
#include "geometry/container.hpp"

namespace packmpi::geometry {

/// [m3] of a sphere of radius `r` whose centre is `b` away from the axis of a vertical cylinder of radius `cylinder`
/// (all [m]), between the heights `low` and `high` above its centre (infinite ones are allowed). Horizontal sections
/// are lenses of two discs, whose area is exact; what is summed over the heights where both discs cut each other is by
/// Gauss' rule of 24 points, the rest in closed form. Error below 1e-9 r^3 (tests/geometry/round_volume.cpp).
[[nodiscard]] double volume_in_cylinder(double r, double b, double cylinder, double low, double high) noexcept;

/// The same of a vertical cone: seen from the sphere's centre, its radius is `radius` at height 0 and grows by `rise` a
/// height; where it is negative there is nothing inside.
[[nodiscard]] double volume_in_cone(double r, double b, double radius, double rise, double low, double high) noexcept;

/// The same of a sphere of radius `around` whose centre is `b` beside and `up` above that of the sphere.
[[nodiscard]] double volume_in_ball(double r, double b, double up, double around, double low, double high) noexcept;

/// The same in 2D, [m2] of a disc of radius `r` in a disc of radius `around`. In closed form.
[[nodiscard]] double area_in_disc(double r, double b, double up, double around, double low, double high) noexcept;

/// [m3] of a sphere, in 2D [m2] of a disc, at `x` of radius `r` what is at least `margin` away from the wall `surface`
/// of a round vessel, on its inner side, and between the heights `low` and `high` of the vessel (all [m]). Of a
/// polygon: away from all its sides but the floor. Error below 1e-9 r^3, or r^2.
[[nodiscard]] double volume_away_from(const Container& vessel, Surface surface, double margin, const Vec3& x, double r,
                                      double low, double high) noexcept;

}  // namespace packmpi::geometry
