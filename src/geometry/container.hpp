/// The container: the only place that knows its shape. Extents, walls, cross-section, periodic wrap.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

#include "base/types.hpp"
#include "geometry/polygon.hpp"
#include "mesh/surface.hpp"

namespace packmpi::geometry {

/// A wall by its number: 0 floor; 1, 2 low and high side of x; 3, 4 of y (3D only); 5 the lid; 6 the mantle of a
/// round vessel; 7 the inner wall of an annulus; 8 what goes on above a frustum that widens; from most_surfaces on the
/// faces, edges and corners of a mesh, or what sides of a polygon are none of the planes.
enum class Surface : std::int32_t {
  floor = 0,
  x_low = 1,
  x_high = 2,
  y_low = 3,
  y_high = 4,
  lid = 5,
  mantle = 6,
  inner = 7,
  collar = 8
};
inline constexpr std::size_t most_planes = 6;  ///< surfaces below it are planes across an axis
inline constexpr std::size_t most_round = 3;   ///< those from it on are round walls
inline constexpr std::size_t most_surfaces = most_planes + most_round;
inline constexpr std::size_t most_walls = most_surfaces + (std::size_t{1} << 24U);  ///< no mesh has as many parts

/// What the vessel looks like: a rectangle or prism, a body of revolution about a vertical axis (in 2D a sphere is a
/// circle), the inside of a mesh, or, in 2D, of a polygon.
enum class Shape : std::int32_t { box, cylinder, frustum, sphere, annulus, mesh, polygon };

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

/// A wall that is round about a vertical axis or about a point. With d = x - centre and rho = sqrt(sum of weight d d),
/// a point x is offset - radial rho - lean x away from it, and radial weight d / rho + lean points towards it. Of a
/// cylinder of radius R about a vertical axis, seen from inside, offset is R; seen from outside offset is -R and radial
/// -1. Of a sphere all weights are 1. Of a cone whose radius is R at z = 0 and grows by tan(b) a height, offset is
/// R cos(b), radial cos(b), lean (0, 0, -sin(b)). On the axis itself the part with d is zero. The step kernel has this
/// formula once more (put_round in dynamics/kernel_motion.hpp): operation by operation the same.
struct RoundWall {
  Vec3 centre{};        ///< [m] where it stands
  double offset = 0.0;  ///< [m]
  double radial = 1.0;
  Vec3 weight{1.0, 1.0, 0.0};  ///< 0 or 1
  Vec3 lean{};

  static constexpr double tiny = 1e-300;  ///< [m2] no point is as near to the axis, but those on it
  /// [m] from the axis, or the point.
  [[nodiscard]] double from_axis(const Vec3& x) const {
    const double a = x[0] - centre[0], b = x[1] - centre[1], c = x[2] - centre[2];
    return std::sqrt(weight[0] * (a * a) + weight[1] * (b * b) + weight[2] * (c * c) + tiny);
  }
  [[nodiscard]] Facing facing(const Vec3& x) const {
    const double rho = from_axis(x);
    const double inverse = 1.0 / rho;
    const auto along = [&](std::size_t a) { return radial * (weight[a] * ((x[a] - centre[a]) * inverse)) + lean[a]; };
    return {offset - radial * rho - (lean[0] * x[0] + lean[1] * x[1] + lean[2] * x[2]), {along(0), along(1), along(2)}};
  }
};
using RoundWalls = std::array<RoundWall, most_round>;

/// Where the points of a height are that lie inside a round vessel: between two circles about its axis; in 2D on both
/// sides of it.
struct Ring {
  double inner, outer;  ///< [m]; both 0: nowhere
};

/// A rectangle (2D: x lateral, y vertical) or prism (3D: x, y lateral, z vertical), lower corner at the origin, open at
/// the top or under a lid, whose lateral axes end in walls or are periodic; or a body of revolution about a vertical
/// axis, which stands in such a prism and touches its sides: a cylinder, a frustum (which goes on above H_d as a
/// cylinder if it widens, else as the cone that it is), a sphere that is filled up to H_d, or an annulus; or what is
/// inside a closed surface of triangles, which has no floor of its own. In 2D there are, beside the rectangle, the
/// circle, and convex polygons, trapezia among them.
struct Container {
  int dimension = 3;
  Vec3 size{};  ///< [m] the bounding box: lateral extents, then the target height H_d; unused entries 0
  std::array<bool, 2> periodic{};            ///< per lateral axis; none of a round vessel
  std::optional<double> lid = std::nullopt;  ///< [m] height of a rigid lid; none: open at the top
  Vec3 speed{-0.0, -0.0, -0.0};  ///< [m/s] of walls that move: the high one of each lateral axis, and the lid
  Shape shape = Shape::box;
  std::array<double, 2> ends{};             ///< [m] radii of a frustum at the floor and at H_d
  double core = 0.0;                        ///< [m] radius of the inner wall of an annulus
  const mesh::Surface* interior = nullptr;  ///< of a mesh; its owner is asked::Container
  double deepest = 0.0;                     ///< [m] of a mesh: half the smallest radius, see mesh::Table
  const Polygon* polygon = nullptr;         ///< of a polygon; its owner is asked::Container

  [[nodiscard]] constexpr int lateral_axes() const { return dimension - 1; }
  [[nodiscard]] constexpr int vertical() const { return dimension - 1; }
  [[nodiscard]] constexpr double height() const { return size[static_cast<std::size_t>(dimension - 1)]; }  ///< H_d [m]
  [[nodiscard]] constexpr bool is_box() const { return shape == Shape::box; }
  /// The same cross-section at every height?
  [[nodiscard]] constexpr bool straight() const {
    return shape != Shape::frustum && shape != Shape::sphere && !is_mesh() && !is_polygon();
  }
  [[nodiscard]] constexpr bool is_mesh() const { return shape == Shape::mesh; }
  [[nodiscard]] constexpr bool is_polygon() const { return shape == Shape::polygon; }
  /// Does it narrow towards the top, so that nothing has room far above H_d?
  [[nodiscard]] constexpr bool closes() const {
    if (is_polygon()) return polygon->top() < HUGE_VAL;
    return shape == Shape::sphere || is_mesh() || (shape == Shape::frustum && ends[1] < ends[0]);
  }
  [[nodiscard]] constexpr double radius() const { return 0.5 * size[0]; }  ///< [m] of a round vessel where it is widest
  /// The point at a lateral place, whose second coordinate 2D has not, and a height [m].
  [[nodiscard]] constexpr Vec3 at(double x, double y, double height) const {
    return dimension == 3 ? Vec3{x, y, height} : Vec3{x, height, 0.0};
  }

  /// Of the horizontal cross-section at a height [m]: [m2]; 2D: its length [m].
  [[nodiscard]] double area_at(double height) const;
  /// Its mean over `thickness` [m] above the height `low` [m].
  [[nodiscard]] double mean_area(double low, double thickness) const {
    return straight() ? section() : volume_between(low, low + thickness) / thickness;
  }
  /// Its mean below H_d.
  [[nodiscard]] double mean_area() const { return mean_area(0.0, height()); }
  /// Of the container's inside between two heights [m]: [m3]; 2D: [m2]. Exact.
  [[nodiscard]] double volume_between(double low, double high) const {
    return straight() ? section() * (high - low) : volume_within(0.0, low, high);
  }
  /// The height [m] below which the inside has this volume [m3]; of one that closes its top at most.
  [[nodiscard]] double level(double volume) const;
  /// Of the side walls up to a height [m]: [m2]; 2D: [m].
  [[nodiscard]] double wall_area(double up_to) const;
  /// Side walls over the interior below H_d [1/m].
  [[nodiscard]] double walls_over_volume() const;

  /// Has this container this wall? Periodic axes have none.
  [[nodiscard]] constexpr bool has(Surface surface) const {
    const auto number = static_cast<std::size_t>(surface);
    if (surface == Surface::lid) return lid.has_value();
    if (is_mesh()) return interior != nullptr && number >= most_surfaces;
    if (is_polygon()) {
      return polygon->has_plane(number) ||
             (number >= most_surfaces && number - most_surfaces < polygon->sloping().size());
    }
    if (number == 0) return shape != Shape::sphere;
    if (!is_box()) {
      return surface == Surface::mantle || (surface == Surface::inner && shape == Shape::annulus) ||
             (surface == Surface::collar && shape == Shape::frustum && ends[0] < ends[1]);
    }
    const std::size_t axis = (number - 1) / 2;
    return axis < static_cast<std::size_t>(lateral_axes()) && !periodic[axis];
  }
  /// The round wall of the number most_planes + k, of those that it has not, too.
  [[nodiscard]] RoundWall round(std::size_t k) const;
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
  [[nodiscard]] Facing facing(Surface wall, const Vec3& x) const {
    const auto number = static_cast<std::size_t>(wall);
    if (number >= most_surfaces) return facing_part(number - most_surfaces, x);
    if (number >= most_planes) return round(number - most_planes).facing(x);
    const Plane flat = plane(wall);
    Facing facing{flat.distance(x), flat.normal()};
    facing.velocity[static_cast<std::size_t>(flat.axis)] = flat.speed;
    return facing;
  }
  /// Not of a mesh. Calls found(surface, distance [m]) for each wall nearer to `x` than `range` [m], in the order of
  /// their numbers.
  template <class Found>
  void near_walls(const Vec3& x, double range, Found&& found) const {
    const std::size_t sloping = is_polygon() ? polygon->sloping().size() : 0;
    const std::size_t walls = is_box() ? most_planes : most_surfaces + sloping;
    for (std::size_t number = 0; number < walls; ++number) {
      const auto surface = static_cast<Surface>(number);
      if (!has(surface)) continue;
      if (const double distance = facing(surface, x).distance; distance < range) found(surface, distance);
    }
  }
  /// How far `x` is behind a wall or the end of a periodic axis [m]; negative: inside. NaN if a coordinate is.
  [[nodiscard]] double beyond(const Vec3& x) const {
    double most = is_mesh()             ? interior->beyond(x)
                  : has(Surface::floor) ? -plane(Surface::floor).distance(x)
                                        : -HUGE_VAL;
    const auto take = [&](double here) {
      if (here > most || here != here) most = here;
    };
    for (std::size_t number = 1; is_box() && number <= 2 * static_cast<std::size_t>(lateral_axes()); ++number) {
      take(-plane(static_cast<Surface>(number)).distance(x));
    }
    if (!is_box() && !is_mesh()) take(-from_sides(x));
    if (lid) take(-plane(Surface::lid).distance(x));
    return most;
  }
  /// Not of a mesh. From the nearest side wall of a round vessel or polygon [m]; negative: behind it. NaN if a
  /// coordinate is. Of a box: infinite.
  [[nodiscard]] double from_sides(const Vec3& x) const {
    if (is_polygon()) return polygon->from_sides(x);
    double least = HUGE_VAL;
    for (std::size_t k = 0; k < most_round && !is_box(); ++k) {
      if (!has(static_cast<Surface>(most_planes + k))) continue;
      const double here = round(k).facing(x).distance;
      if (here < least || here != here) least = here;
    }
    return least;
  }
  /// Is the point inside the side walls of a round vessel and at least `margin` [m] away from them? In a box: yes.
  [[nodiscard]] bool holds(const Vec3& x, double margin) const {
    if (is_mesh()) return margin > 0.0 ? interior->fits(x, margin) : interior->beyond(x) <= 0.0;
    return is_box() || from_sides(x) >= margin;
  }

  /// Where at a height [m] the points of a round vessel are that its side walls are `margin` [m] away from at least.
  [[nodiscard]] Ring ring(double height, double margin) const;
  /// Volume of such points between two heights [m]: [m3]; 2D: [m2]. Exact.
  [[nodiscard]] double volume_within(double margin, double low, double high) const;
  /// The place of a centre for uniform numbers `u` in [0, 1): evenly over where a particle of `radius` [m] fits between
  /// the side walls and within `thickness` [m] above the height `low` [m]. Of a mesh or a polygon its z is NaN if
  /// none was found.
  [[nodiscard]] Vec3 draw(const Vec3& u, double radius, double low, double thickness) const;

  /// Of what lies inside a round vessel the part with `axis` (0 or 1) between `from` and `to` and between two heights
  /// (all [m]): [m3], to 1e-9 of the vessel's radius cubed; 2D: [m2], exact.
  [[nodiscard]] double slab(std::size_t axis, double from, double to, double low, double high) const;
  /// Calls found(normal, distance [m]) of planes nearer to `x` than `range` [m] that touch the side walls of a round
  /// vessel from outside, a twentieth of a radian apart: they leave a thousandth at most of what lies beside it. Of a
  /// wall that is seen from outside the one plane nearest to `x`.
  void touching_planes(const Vec3& x, double range, const std::function<void(const Vec3&, double)>& found) const;

 private:
  [[nodiscard]] Facing facing_part(std::size_t part, const Vec3& x) const;  // of a mesh or polygon
  [[nodiscard]] constexpr double section() const {                          // of a straight one, at every height
    if (shape == Shape::annulus) return std::numbers::pi * ((radius() - core) * (radius() + core));
    if (!is_box()) return std::numbers::pi * (radius() * radius());
    return dimension == 3 ? size[0] * size[1] : size[0];
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
