#include "mesh/convex.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "mesh/vectors.hpp"

namespace packmpi::mesh {
namespace {

/// A face of a mesh.
struct Face {
  Vec3 normal;  // out of the interior
  double offset;
  std::vector<Vec3> points;  // of its triangles
  Vec3 longest{};            // of their edges
};

/// By their numbers. None if the interior is not convex: an edge sticks out, or a corner is beyond a face.
std::vector<Face> faces_of_convex(const Surface& surface) {
  const Shell& shell = surface.shell();
  if (surface.features().count() != surface.features().edge_begin()) return {};
  std::vector<Face> faces;
  const double* plane = surface.features().table(0.0).faces;
  for (std::int32_t k = 0; k < surface.features().edge_begin(); ++k, plane += 4) {
    faces.push_back({{plane[0], plane[1], plane[2]}, plane[3], {}});
    const auto beyond = [&](const Vec3& x) {
      return dot(faces.back().normal, x) > faces.back().offset + 3.0 * shell.tolerance;
    };
    if (std::ranges::any_of(shell.points, beyond)) return {};
  }
  for (std::size_t t = 0; t < shell.triangles.size(); ++t) {
    const Corners corners = shell.corners(t);
    const std::int32_t number = surface.features().face_of(t);
    if (number < 0) continue;  // a needle
    Face& face = faces[static_cast<std::size_t>(number)];
    for (std::size_t k = 0; k < 3; ++k) {
      face.points.push_back(corners[k]);
      const Vec3 edge = minus(corners[(k + 1) % 3], corners[k]);
      if (norm(edge) > norm(face.longest)) face.longest = edge;
    }
  }
  return faces;
}

/// A right triangle over the rectangle around a face. Beyond the face it is outside of a convex interior, and a sphere
/// in the interior has its nearest place of the plane in the face, or does not touch it.
Corners triangle_over(const Face& face) {
  const Vec3 u = unit(face.longest), v = cross(face.normal, u);
  std::array<double, 2> low{HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL};
  for (const Vec3& x : face.points) {
    const std::array<double, 2> at{dot(u, x), dot(v, x)};
    for (std::size_t k = 0; k < 2; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
  }
  const auto place = [&](double a, double b) {
    return plus(times(face.offset, face.normal), plus(times(a, u), times(b, v)));
  };
  return {place(low[0], low[1]), place(2.0 * high[0] - low[0], low[1]), place(low[0], 2.0 * high[1] - low[1])};
}

}  // namespace

std::vector<Corners> triangles_over_faces(const Surface& surface) {
  std::vector<Corners> triangles;
  std::ranges::transform(faces_of_convex(surface), std::back_inserter(triangles), triangle_over);
  return triangles;
}

}  // namespace packmpi::mesh
