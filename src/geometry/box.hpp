/// The container: axes, walls, periodic wrap.
#pragma once
#include <array>

#include "base/types.hpp"

namespace packmpi::geometry {

/// A rectangle (2D: x lateral, y vertical) or prism (3D: x, y lateral, z vertical), lower corner at the origin, open at
/// the top. Lateral axes end in walls or are periodic.
struct Box {
  int dimension = 3;
  Vec3 size{};                     ///< [m] lateral extents, then the desired height H_d; unused entries 0
  std::array<bool, 2> periodic{};  ///< per lateral axis

  [[nodiscard]] constexpr int lateral_axes() const { return dimension - 1; }
  [[nodiscard]] constexpr int vertical() const { return dimension - 1; }
  [[nodiscard]] constexpr double height() const { return size[static_cast<std::size_t>(dimension - 1)]; }  ///< H_d [m]
  /// [m2]; 2D: the floor's length [m]
  [[nodiscard]] constexpr double floor_area() const { return dimension == 3 ? size[0] * size[1] : size[0]; }
};

/// The position in [0, L) of a periodic axis, for x within one period of it: the one formula of the whole program.
[[nodiscard]] constexpr double wrap(double x, double period) {
  x = x < 0.0 ? x + period : x;
  return x >= period ? x - period : x;
}

/// The shortest image of a difference d of two wrapped positions: exactly antisymmetric in d.
[[nodiscard]] constexpr double shortest(double d, double period) {
  const double half = 0.5 * period;
  d = d > half ? d - period : d;
  return d < -half ? d + period : d;
}

/// From `first` to the nearest image of `second` [m]; z = 0 in 2D.
[[nodiscard]] constexpr Vec3 separation(const Box& box, const Vec3& first, const Vec3& second) {
  Vec3 d{};
  for (std::size_t a = 0; a < 3; ++a) {
    d[a] = second[a] - first[a];
    if (a < static_cast<std::size_t>(box.lateral_axes()) && box.periodic[a]) d[a] = shortest(d[a], box.size[a]);
  }
  return d;
}

}  // namespace packmpi::geometry
