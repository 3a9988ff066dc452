/// The container: the only place that knows its shape. Extents, walls, cross-section, periodic wrap.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "base/types.hpp"

namespace packmpi::geometry {

/// A wall by its number: 0 floor; 1, 2 low and high side of x; 3, 4 of y (3D only); 5 the lid.
enum class Surface : std::int32_t { floor = 0, x_low = 1, x_high = 2, y_low = 3, y_high = 4, lid = 5 };
inline constexpr std::size_t most_surfaces = 6;

/// A flat wall across one axis: distance of a point = offset - sign * x[axis], normal = sign along the axis, towards
/// the wall.
struct Plane {
  int axis;
  double sign, offset;
  double speed = -0.0;  ///< [m/s] of the wall along the axis; at rest -0, so that speed - v is -v to the bit

  [[nodiscard]] constexpr double distance(const Vec3& x) const {
    return offset - sign * x[static_cast<std::size_t>(axis)];
  }
  [[nodiscard]] constexpr Vec3 normal() const {
    Vec3 n{};
    n[static_cast<std::size_t>(axis)] = sign;
    return n;
  }
};

/// A rectangle (2D: x lateral, y vertical) or prism (3D: x, y lateral, z vertical), lower corner at the origin, open at
/// the top or under a lid. Lateral axes end in walls or are periodic. The first shape; others will answer the same
/// questions.
struct Container {
  int dimension = 3;
  Vec3 size{};  ///< [m] the bounding box: lateral extents, then the target height H_d; unused entries 0
  std::array<bool, 2> periodic{};            ///< per lateral axis
  std::optional<double> lid = std::nullopt;  ///< [m] height of a rigid lid; none: open at the top
  Vec3 speed{-0.0, -0.0, -0.0};  ///< [m/s] of walls that move: the high one of each lateral axis, and the lid

  [[nodiscard]] constexpr int lateral_axes() const { return dimension - 1; }
  [[nodiscard]] constexpr int vertical() const { return dimension - 1; }
  [[nodiscard]] constexpr double height() const { return size[static_cast<std::size_t>(dimension - 1)]; }  ///< H_d [m]
  /// Of the horizontal cross-section at a height [m]: [m2]; 2D: its length [m].
  [[nodiscard]] constexpr double area(double /*height*/) const { return floor_area(); }
  [[nodiscard]] constexpr double floor_area() const { return dimension == 3 ? size[0] * size[1] : size[0]; }
  /// Of the container's inside between two heights [m]: [m3]; 2D: [m2].
  [[nodiscard]] constexpr double volume_between(double low, double high) const { return floor_area() * (high - low); }

  /// Has this container this wall? Periodic axes have none.
  [[nodiscard]] constexpr bool has(Surface surface) const {
    const auto number = static_cast<std::size_t>(surface);
    if (surface == Surface::lid) return lid.has_value();
    const std::size_t axis = (number - 1) / 2;
    return number == 0 || (axis < static_cast<std::size_t>(lateral_axes()) && !periodic[axis]);
  }
  /// The wall of that number, whether this container has it or not.
  [[nodiscard]] constexpr Plane plane(Surface surface) const {
    const int number = static_cast<int>(surface);
    if (number == 0) return {vertical(), -1.0, 0.0};
    if (surface == Surface::lid) {
      return {vertical(), 1.0, lid.value_or(0.0), speed[static_cast<std::size_t>(vertical())]};
    }
    const int axis = (number - 1) / 2;
    const auto a = static_cast<std::size_t>(axis);
    if (number % 2 == 0) return {axis, 1.0, size[a], speed[a]};
    return {axis, -1.0, 0.0};
  }
  /// Calls found(surface, distance [m]) for each wall nearer to `x` than `range` [m], in the order of their numbers.
  template <class Found>
  constexpr void near_walls(const Vec3& x, double range, Found&& found) const {
    for (std::size_t number = 0; number < most_surfaces; ++number) {
      const auto surface = static_cast<Surface>(number);
      if (!has(surface)) continue;
      if (const double distance = plane(surface).distance(x); distance < range) found(surface, distance);
    }
  }
  /// How far `x` is behind a wall or the end of a periodic axis [m]; negative: inside. NaN if a coordinate is.
  [[nodiscard]] constexpr double beyond(const Vec3& x) const {
    double most = -plane(Surface::floor).distance(x);
    for (std::size_t number = 1; number <= 2 * static_cast<std::size_t>(lateral_axes()); ++number) {
      const double here = -plane(static_cast<Surface>(number)).distance(x);
      if (here > most || here != here) most = here;
    }
    if (lid) {
      const double here = -plane(Surface::lid).distance(x);
      if (here > most || here != here) most = here;
    }
    return most;
  }
  /// The lateral place of a centre for uniform numbers `u` in [0, 1): evenly over where a particle of `radius` [m]
  /// fits. The vertical component is 0.
  [[nodiscard]] constexpr Vec3 draw(const Vec3& u, double radius) const;
};

/// The position in [0, L) of a periodic axis, for x within one period of it: the one formula of the whole program.
[[nodiscard]] constexpr double wrap(double x, double period) {
  x = x < 0.0 ? x + period : x;
  return x >= period ? x - period : x;
}

constexpr Vec3 Container::draw(const Vec3& u, double radius) const {
  Vec3 place{};
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(lateral_axes()); ++axis) {
    place[axis] =
        periodic[axis] ? wrap(u[axis] * size[axis], size[axis]) : radius + u[axis] * (size[axis] - 2.0 * radius);
  }
  return place;
}

/// The shortest image of a difference d of two wrapped positions: exactly antisymmetric in d.
[[nodiscard]] constexpr double shortest(double d, double period) {
  const double half = 0.5 * period;
  d = d > half ? d - period : d;
  return d < -half ? d + period : d;
}

/// From `first` to the nearest image of `second` [m]; z = 0 in 2D.
[[nodiscard]] constexpr Vec3 separation(const Container& container, const Vec3& first, const Vec3& second) {
  Vec3 d{};
  for (std::size_t a = 0; a < 3; ++a) {
    d[a] = second[a] - first[a];
    if (a < static_cast<std::size_t>(container.lateral_axes()) && container.periodic[a]) {
      d[a] = shortest(d[a], container.size[a]);
    }
  }
  return d;
}

}  // namespace packmpi::geometry
