/// The part of a sphere that lies inside a vertical cylinder, between two heights.
#pragma once

namespace packmpi::geometry {

/// [m3] of a sphere of radius `r` whose centre is `b` away from the axis of a vertical cylinder of radius `cylinder`
/// (all [m]), between the heights `low` and `high` above its centre (infinite ones are allowed). Horizontal sections
/// are lenses of two discs, whose area is exact; what is summed over the heights where both discs cut each other is by
/// Gauss' rule of 24 points, the rest in closed form. Error below 1e-9 r^3 (tests/geometry/round_volume.cpp).
[[nodiscard]] double volume_in_cylinder(double r, double b, double cylinder, double low, double high) noexcept;

}  // namespace packmpi::geometry
