/// Volumes of spheres and areas of discs, whole and cut by a horizontal plane (CC16 eq. 22).
#pragma once

namespace packmpi::geometry {

/// Solid volume of a particle: sphere [m3] or disc [m2].
[[nodiscard]] double volume(int dimension, double radius) noexcept;

/// The part of the particle below the plane `height`, its centre at `centre` (both along the vertical) [m].
/// Sphere: cap pi h^2 (3 r - h) / 3; disc: circular segment. Exact; 0 or all of it when the plane misses.
[[nodiscard]] double volume_below(int dimension, double radius, double centre, double height) noexcept;

}  // namespace packmpi::geometry
