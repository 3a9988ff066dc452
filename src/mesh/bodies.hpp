/// Triangles moved and measured, and closed surfaces of simple bodies, whose triangles look outside [m].
#pragma once
#include <vector>

#include "mesh/read.hpp"

namespace packmpi::mesh {

/// Facets around a body of revolution, and rings of a sphere from pole to pole. Few for a fuzzer, whose trials are
/// many.
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
inline constexpr int around = 12, around_sphere = 8, rings = 4;
#else
inline constexpr int around = 180, around_sphere = 72, rings = 36;
#endif

/// The lower and the upper corner of the box around triangles [their unit]. Pure.
[[nodiscard]] std::array<Vec3, 2> box_around(const std::vector<Corners>& triangles);

/// Every corner x at move(x).
template <class Move>
[[nodiscard]] std::vector<Corners> moved(std::vector<Corners> triangles, const Move& move) {
  for (Corners& corners : triangles) {
    for (Vec3& x : corners) x = move(x);
  }
  return triangles;
}

/// A corner of the half of a section through the axis: distance from the axis and height [m].
using Profile = std::vector<std::array<double, 2>>;

/// A prism over a convex polygon [x, y] that goes round anticlockwise, from z = 0 up to `height`. Pure.
[[nodiscard]] std::vector<Corners> prism_over(const std::vector<std::array<double, 2>>& polygon, double height);

/// The body that a section makes around the z axis: from a point of the axis up to another, or all around. Its sections
/// are regular polygons of `facets` corners, a multiple of 4, as large as the circles that they stand for, and turned
/// so that two corners lie on each axis. Pure.
[[nodiscard]] std::vector<Corners> body_of_revolution(const Profile& profile, int facets = around);

/// About the origin, as large as the sphere of this radius [m]. Pure.
[[nodiscard]] std::vector<Corners> sphere_of_facets(double radius);

}  // namespace packmpi::mesh
