/// The container: the only place that knows its shape. Extents, walls, cross-section, periodic wrap.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>

#include "base/types.hpp"

namespace packmpi::geometry {

/// A wall by its number: 0 floor; 1, 2 low and high side of x; 3, 4 of y (3D only); 5 the lid; 6 the mantle of a
/// round vessel.
enum class Surface : std::int32_t { floor = 0, x_low = 1, x_high = 2, y_low = 3, y_high = 4, lid = 5, mantle = 6 };
inline constexpr std::size_t most_planes = 6;  ///< surfaces below it are planes across an axis
inline constexpr std::size_t most_round = 1;   ///< those from it on are round walls
inline constexpr std::size_t most_surfaces = most_planes + most_round;

/// What the vessel looks like: a rectangle or prism, or a vertical cylinder.
enum class Shape : std::int32_t { box, cylinder };

/// Where a wall is, seen from a point: its distance [m], negative behind it, the unit vector towards it, and how it
/// moves [m/s]; -0 where it stands, so that -0 - v is -v.
struct Facing {
  double distance;
  Vec3 normal;
  Vec3 velocity{-0.0, -0.0, -0.0};
};

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

/// A wall that is round about a vertical axis, seen from inside: distance of a point = offset - its distance from the
/// axis, the normal points away from the axis. On the axis itself the normal is zero. The step kernel has this formula
/// once more (put_round in dynamics/kernel_motion.hpp): operation by operation the same.
struct RoundWall {
  std::array<double, 2> axis{};  ///< [m] where it stands
  double offset = 0.0;           ///< [m] its radius

  static constexpr double tiny = 1e-300;  ///< [m2] no point is as near to the axis, but those on it
  [[nodiscard]] double from_axis(const Vec3& x) const {
    const double a = x[0] - axis[0], b = x[1] - axis[1];
    return std::sqrt(a * a + b * b + tiny);
  }
  [[nodiscard]] Facing facing(const Vec3& x) const {
    const double a = x[0] - axis[0], b = x[1] - axis[1];
    const double rho = std::sqrt(a * a + b * b + tiny);
    const double inverse = 1.0 / rho;
    return {offset - rho, {a * inverse, b * inverse, 0.0}};
  }
};
using RoundWalls = std::array<RoundWall, most_round>;

/// A rectangle (2D: x lateral, y vertical) or prism (3D: x, y lateral, z vertical), lower corner at the origin, open at
/// the top or under a lid, whose lateral axes end in walls or are periodic; or a vertical cylinder that stands in such
/// a prism and touches its sides.
struct Container {
  int dimension = 3;
  Vec3 size{};  ///< [m] the bounding box: lateral extents, then the target height H_d; unused entries 0
  std::array<bool, 2> periodic{};            ///< per lateral axis; none of a round vessel
  std::optional<double> lid = std::nullopt;  ///< [m] height of a rigid lid; none: open at the top
  Vec3 speed{-0.0, -0.0, -0.0};  ///< [m/s] of walls that move: the high one of each lateral axis, and the lid
  Shape shape = Shape::box;

  [[nodiscard]] constexpr int lateral_axes() const { return dimension - 1; }
  [[nodiscard]] constexpr int vertical() const { return dimension - 1; }
  [[nodiscard]] constexpr double height() const { return size[static_cast<std::size_t>(dimension - 1)]; }  ///< H_d [m]
  [[nodiscard]] constexpr bool is_box() const { return shape == Shape::box; }
  [[nodiscard]] constexpr double radius() const { return 0.5 * size[0]; }  ///< [m] of a round vessel
  /// Of the horizontal cross-section, the same at every height: [m2]; 2D: its length [m].
  [[nodiscard]] constexpr double floor_area() const {
    if (!is_box()) return std::numbers::pi * (radius() * radius());
    return dimension == 3 ? size[0] * size[1] : size[0];
  }
  /// Of the container's inside between two heights [m]: [m3]; 2D: [m2].
  [[nodiscard]] constexpr double volume_between(double low, double high) const { return floor_area() * (high - low); }
  /// Of the side walls up to a height [m]: [m2]; 2D: [m].
  [[nodiscard]] constexpr double wall_area(double up_to) const {
    if (!is_box()) return 2.0 * std::numbers::pi * radius() * up_to;
    double area = 0.0;
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(lateral_axes()); ++axis) {
      if (!periodic[axis]) area += 2.0 * floor_area() / size[axis] * up_to;
    }
    return area;
  }

  /// Has this container this wall? Periodic axes have none.
  [[nodiscard]] constexpr bool has(Surface surface) const {
    const auto number = static_cast<std::size_t>(surface);
    if (number == 0) return true;
    if (surface == Surface::lid) return lid.has_value();
    if (!is_box()) return number == most_planes;
    const std::size_t axis = (number - 1) / 2;
    return axis < static_cast<std::size_t>(lateral_axes()) && !periodic[axis];
  }
  /// The round wall of the number most_planes + k, of those that it has not, too.
  [[nodiscard]] constexpr RoundWall round(std::size_t /*k*/) const {
    return {{0.5 * size[0], 0.5 * size[1]}, radius()};
  }
  /// The flat wall of that number, whether this container has it or not. Below most_planes.
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
  /// Where the wall of that number is, seen from `x`. Of those that this container has.
  [[nodiscard]] Facing facing(Surface surface, const Vec3& x) const {
    const auto number = static_cast<std::size_t>(surface);
    if (number >= most_planes) return round(number - most_planes).facing(x);
    const Plane flat = plane(surface);
    Facing facing{flat.distance(x), flat.normal()};
    facing.velocity[static_cast<std::size_t>(flat.axis)] = flat.speed;
    return facing;
  }
  /// Calls found(surface, distance [m]) for each wall nearer to `x` than `range` [m], in the order of their numbers.
  template <class Found>
  void near_walls(const Vec3& x, double range, Found&& found) const {
    for (std::size_t number = 0; number < most_surfaces; ++number) {
      const auto surface = static_cast<Surface>(number);
      if (!has(surface)) continue;
      if (const double distance = facing(surface, x).distance; distance < range) found(surface, distance);
    }
  }
  /// How far `x` is behind a wall or the end of a periodic axis [m]; negative: inside. NaN if a coordinate is.
  [[nodiscard]] double beyond(const Vec3& x) const {
    double most = -plane(Surface::floor).distance(x);
    if (!is_box()) {
      const double here = -round(0).facing(x).distance;
      return here > most || here != here ? here : most;
    }
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
  [[nodiscard]] Vec3 draw(const Vec3& u, double radius) const;
  /// Is the point of the floor (x, y) inside the side walls and at least `margin` [m] away from them?
  [[nodiscard]] bool holds(double x, double y, double margin) const {
    return is_box() || round(0).facing({x, y, 0.0}).distance >= margin;
  }
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
