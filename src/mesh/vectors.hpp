/// Sums and products of vectors.
#pragma once
#include "base/types.hpp"

namespace packmpi::mesh {

[[nodiscard]] constexpr Vec3 plus(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
[[nodiscard]] constexpr Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
[[nodiscard]] constexpr Vec3 times(double s, const Vec3& a) { return {s * a[0], s * a[1], s * a[2]}; }
[[nodiscard]] constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
/// Of length 1; zero stays zero.
[[nodiscard]] inline Vec3 unit(const Vec3& a) {
  const double length = norm(a);
  return length > 0.0 ? times(1.0 / length, a) : Vec3{};
}

/// The angle in [0, pi] of a vector of the plane (x, y) with y >= 0. The same on every machine.
[[nodiscard]] double angle_of(double x, double y) noexcept;

}  // namespace packmpi::mesh
