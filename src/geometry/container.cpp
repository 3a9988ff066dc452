#include "geometry/container.hpp"

#include <algorithm>

#include "base/elementary.hpp"
#include "geometry/cut_volume.hpp"
#include "geometry/gauss.hpp"
#include "geometry/volume.hpp"

namespace packmpi::geometry {
namespace {

// The wall of a frustum: its radius at the floor, by how much it grows a height, and the cosine of its slope.
struct Cone {
  double low, rise, cosine;

  explicit Cone(const Container& frustum)
      : low(frustum.ends[0]),
        rise((frustum.ends[1] - frustum.ends[0]) / frustum.height()),
        cosine(1.0 / std::sqrt(1.0 + rise * rise)) {}
  // Where points are `margin` away from it.
  [[nodiscard]] double radius(double height, double margin) const { return low + rise * height - margin / cosine; }
  [[nodiscard]] double height(double radius, double margin) const { return (radius - low + margin / cosine) / rise; }
};

// Between two heights of a cone whose radius goes from a to b; negative ones are none.
double volume_of_cone(double a, double b, double high) {
  if (!(high > 0.0) || (a <= 0.0 && b <= 0.0)) return 0.0;
  if (a < 0.0) return volume_of_cone(0.0, b, high * (b / (b - a)));
  if (b < 0.0) return volume_of_cone(a, 0.0, high * (a / (a - b)));
  return std::numbers::pi / 3.0 * high * (a * a + a * b + b * b);
}

double room_in_frustum(const Container& vessel, double margin, double low, double high) {
  const Cone cone(vessel);
  const auto between = [&](double from, double to) {
    return volume_of_cone(cone.radius(from, margin), cone.radius(to, margin), to - from);
  };
  if (!vessel.has(Surface::collar)) return between(low, high);
  const double above = std::max(0.0, vessel.ends[1] - margin);
  const double edge = std::clamp(cone.height(vessel.ends[1] - margin, margin), low, high);  // of cone and collar
  return between(low, edge) + std::numbers::pi * (above * above) * (high - edge);
}

double room_in_sphere(const Container& vessel, double margin, double low, double high) {
  const double centre = vessel.radius(), r = std::max(0.0, centre - margin);
  if (vessel.dimension == 2) return r > 0.0 ? volume_below(2, r, centre, high) - volume_below(2, r, centre, low) : 0.0;
  const double from = std::clamp(low - centre, -r, r), to = std::clamp(high - centre, -r, r);
  return std::numbers::pi * (to - from) * (r * r - (from * from + from * to + to * to) / 3.0);
}

// The t in [low, high] at which a function that rises from 0 reaches `value`.
template <class Rising>
double place_of(double value, double low, double high, const Rising& rising) {
  for (int turn = 0; turn < 56; ++turn) {
    const double middle = 0.5 * (low + high);
    (rising(middle) < value ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// Evenly over a ring: equal areas lie within equal shares of the squared radius.
void draw_in_ring(const Ring& ring, const Vec3& u, Vec3& place) {
  const double inner = ring.inner * ring.inner;
  const double rho =
      ring.inner > 0.0 ? std::sqrt(inner + u[0] * (ring.outer * ring.outer - inner)) : ring.outer * std::sqrt(u[0]);
  const double turn = 4.0 * u[1];  // in quarters; within one the series of the functions hold
  const int quarter = std::min(3, static_cast<int>(turn));
  const double angle = 0.5 * std::numbers::pi * (turn - quarter);
  const double c = rho * elementary::cosine(angle), s = rho * elementary::sine(angle);
  const std::array<std::array<double, 2>, 4> places{{{c, s}, {-s, c}, {-c, -s}, {s, -c}}};
  const auto& [x, y] = places.at(static_cast<std::size_t>(quarter));
  place[0] += x, place[1] += y;
}

// cos and sin of an angle in [0, pi], the latter with the sign of `side`.
std::array<double, 2> turned(double angle, double side) {
  const double quarter = 0.5 * std::numbers::pi;
  const double cosine = angle > quarter ? -elementary::cosine(std::numbers::pi - angle) : elementary::cosine(angle);
  return {cosine, std::copysign(elementary::sine(angle), side)};
}

using Found = std::function<void(const Vec3&, double)>;

// Planes that touch a round wall, which is seen from inside.
struct Touching {
  static constexpr int half_around = 62;
  static constexpr double step = std::numbers::pi / half_around;
  const RoundWall& wall;
  const Vec3& x;
  double range;
  const Found& found;
  double rho = wall.from_axis(x);
  double lean = wall.lean[2] * x[2];
  Vec3 along{1.0, 0.0, 0.0};  // away from the axis or the point; on it any direction will do

  void begin(double on_axis) {
    if (!(rho > on_axis)) return;
    for (std::size_t a = 0; a < 3; ++a) along[a] = wall.weight[a] > 0.0 ? (x[a] - wall.centre[a]) / rho : 0.0;
  }
  // The plane that lies by this angle beside x.
  void take(double cosine, const Vec3& aside, double sine) const {
    const double away = wall.offset - wall.radial * rho * cosine - lean;
    if (away > range) return;
    const auto part = [&](std::size_t a) { return wall.radial * (along[a] * cosine + aside[a] * sine) + wall.lean[a]; };
    found({part(0), part(1), part(2)}, away);
  }
  void around_axis() const {
    for (int k = -half_around; k < half_around; ++k) {
      const auto [cosine, sine] = turned(std::abs(k) * step, k);
      take(cosine, {-along[1], along[0], 0.0}, sine);
    }
  }
  // Rings about the direction of x.
  void around_point() const {
    const std::size_t least = std::abs(along[2]) < 0.5 ? 2 : 0;
    Vec3 first{}, second{};
    for (std::size_t a = 0; a < 3; ++a) first[a] = (a == least ? 1.0 : 0.0) - along[least] * along[a];
    const double length = norm(first);
    for (double& c : first) c /= length;
    for (std::size_t a = 0; a < 3; ++a) {
      const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
      second[a] = along[b] * first[c] - along[c] * first[b];
    }
    for (int polar = 0; polar <= half_around; ++polar) {
      const auto [cosine, sine] = turned(polar * step, 1.0);
      if (wall.offset - rho * cosine > range) break;
      const int count = std::max(1, static_cast<int>(std::ceil(2.0 * half_around * sine)));
      for (int k = 0; k < count; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / count;
        const auto [c, s] = turned(angle > std::numbers::pi ? 2.0 * std::numbers::pi - angle : angle,
                                   angle > std::numbers::pi ? -1.0 : 1.0);
        take(cosine, {c * first[0] + s * second[0], c * first[1] + s * second[1], c * first[2] + s * second[2]}, sine);
      }
    }
  }
};

}  // namespace

RoundWall Container::round(std::size_t k) const {
  const Vec3 axis{0.5 * size[0], 0.5 * size[1], 0.0};
  RoundWall wall{axis, radius()};
  if (k == 1) {
    wall.offset = -core;
    wall.radial = -1.0;
  } else if (k == 0 && shape == Shape::sphere) {
    const auto up = static_cast<std::size_t>(vertical());
    wall.centre[up] = radius();
    wall.weight[up] = 1.0;
  } else if (k == 0 && shape == Shape::frustum) {
    const Cone cone(*this);
    wall.offset = cone.low * cone.cosine;
    wall.radial = cone.cosine;
    wall.lean[2] = -(cone.rise * cone.cosine);
  }
  return wall;
}

Ring Container::ring(double height, double margin) const {
  const auto disc = [](double outer) { return Ring{0.0, std::max(0.0, outer)}; };
  switch (shape) {
    case Shape::sphere: {
      const double r = std::max(0.0, radius() - margin), z = height - radius();
      return disc(std::sqrt(std::max(0.0, (r - z) * (r + z))));
    }
    case Shape::frustum: {
      const double cone = Cone(*this).radius(height, margin);
      return disc(has(Surface::collar) ? std::min(cone, ends[1] - margin) : cone);
    }
    case Shape::annulus:
      return radius() - core > 2.0 * margin ? Ring{core + margin, radius() - margin} : Ring{0.0, 0.0};
    default:
      return disc(radius() - margin);
  }
}

Facing Container::facing_part(std::size_t part, const Vec3& x) const {
  if (is_polygon()) {
    const Side& side = polygon->sloping()[part];
    return {side.distance(x), side.normal};
  }
  const mesh::Touch touch = interior->touch_of(static_cast<std::int32_t>(part), x, deepest);
  return {touch.distance, {touch.normal[0], touch.normal[1], touch.normal[2]}};
}

double Container::volume_within(double margin, double low, double high) const {
  if (!(low < high)) return 0.0;
  if (is_mesh()) return interior->volume_within(margin, low, high);
  if (is_polygon()) return area_of(polygon->within(margin, low, high));
  if (shape == Shape::frustum) return room_in_frustum(*this, margin, low, high);
  if (shape == Shape::sphere) return room_in_sphere(*this, margin, low, high);
  const Ring here = ring(0.0, margin);
  return std::numbers::pi * ((here.outer - here.inner) * (here.outer + here.inner)) * (high - low);
}

double Container::area_at(double height) const {
  if (is_mesh()) return interior->area_at(height);
  if (is_polygon()) return polygon->width_at(height);
  if (straight()) return section();
  const double outer = ring(height, 0.0).outer;
  return dimension == 2 ? 2.0 * outer : std::numbers::pi * (outer * outer);
}

double Container::level(double volume) const {
  if (straight()) return volume / section();
  double top = height();
  const double below = volume_between(0.0, top);
  if (shape == Shape::sphere) top = size[0];
  if (is_mesh()) top = interior->high()[2];
  if (is_polygon() && closes()) top = polygon->top();
  if (shape == Shape::frustum && closes()) top = Cone(*this).height(0.0, 0.0);
  if (volume >= volume_between(0.0, top)) return closes() ? top : top + (volume - below) / area_at(top);
  return place_of(volume, 0.0, top, [&](double z) { return volume_between(0.0, z); });
}

double Container::wall_area(double up_to) const {
  if (is_mesh()) return interior->walls_below(up_to);
  if (is_polygon()) return polygon->sides_below(up_to);
  if (shape == Shape::sphere && dimension == 2) {
    return 4.0 * radius() * elementary::arcsine(std::sqrt(std::clamp(up_to / size[0], 0.0, 1.0)));
  }
  if (shape == Shape::sphere) return 2.0 * std::numbers::pi * radius() * std::min(up_to, size[0]);  // Archimedes
  if (shape == Shape::annulus) return 2.0 * std::numbers::pi * (radius() + core) * up_to;
  if (shape == Shape::frustum) {
    const Cone cone(*this);
    const double edge = has(Surface::collar) ? std::min(up_to, height()) : up_to;
    return std::numbers::pi * (cone.low + std::max(0.0, cone.radius(edge, 0.0))) * edge / cone.cosine +
           2.0 * std::numbers::pi * ends[1] * (up_to - edge);
  }
  if (!is_box()) return 2.0 * std::numbers::pi * radius() * up_to;
  double area = 0.0;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(lateral_axes()); ++axis) {
    if (!periodic[axis]) area += 2.0 * section() / size[axis] * up_to;
  }
  return area;
}

double Container::walls_over_volume() const {
  if (!straight()) return wall_area(height()) / volume_between(0.0, height());
  if (!is_box()) return wall_area(1.0) / section();
  double sum = 0.0;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(lateral_axes()); ++axis) {
    if (!periodic[axis]) sum += 2.0 / size[axis];
  }
  return sum;
}

Vec3 Container::draw(const Vec3& u, double radius, double low, double thickness) const {
  const auto up = static_cast<std::size_t>(vertical());
  const double bottom = low + radius, height = thickness - 2.0 * radius;
  if (is_mesh()) return interior->draw(u, radius, bottom, bottom + height);
  if (is_polygon()) return polygon->draw(u, radius, bottom, bottom + height);
  Vec3 place{};
  place[up] = bottom + u[up] * height;
  if (is_box()) {
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(lateral_axes()); ++axis) {
      place[axis] =
          periodic[axis] ? wrap(u[axis] * size[axis], size[axis]) : radius + u[axis] * (size[axis] - 2.0 * radius);
    }
    return place;
  }
  if (!straight()) {
    const double volume = volume_within(radius, bottom, bottom + height);
    place[up] = volume > 0.0 ? place_of(u[up] * volume, bottom, bottom + height,
                                        [&](double z) { return volume_within(radius, bottom, z); })
                             : bottom + (closes() ? 0.0 : height);
  }
  place[0] = 0.5 * size[0];
  if (dimension == 2) {
    place[0] += (2.0 * u[0] - 1.0) * ring(place[up], radius).outer;
    return place;
  }
  place[1] = 0.5 * size[1];
  draw_in_ring(ring(place[up], radius), u, place);
  return place;
}

double Container::slab(std::size_t axis, double from, double to, double low, double high) const {
  if (is_mesh()) {
    return (interior->volume_below(high, axis, to) - interior->volume_below(high, axis, from)) -
           (interior->volume_below(low, axis, to) - interior->volume_below(low, axis, from));
  }
  if (is_polygon()) return area_of(polygon->within(0.0, low, high, std::max(from, 0.0), std::min(to, size[0])));
  const double middle = 0.5 * size[axis];
  if (dimension == 2) {
    return area_in_rectangle(radius(), {from - middle, low - radius(), 0.0}, {to - middle, high - radius(), 0.0});
  }
  const auto between = [&](double r) {
    const auto below = [&](double x) { return r > 0.0 ? volume_below(2, r, middle, x) : 0.0; };
    return below(to) - below(from);
  };
  const auto section_at = [&](double z) {
    const Ring here = ring(z, 0.0);
    return between(here.outer) - between(here.inner);
  };
  if (straight()) return section_at(low) * (high - low);
  // Heights at which an end of the slab touches the section, or the section begins, ends or stops to grow.
  std::array<double, 9> heights{low, high, high, high, high, high, high, high, high};
  std::size_t count = 2;
  const auto note = [&](double z) {
    if (z > low && z < high) heights.at(count++) = z;
  };
  for (const double r : {std::abs(from - middle), std::abs(to - middle), 0.0}) {
    const double half = std::sqrt(std::max(0.0, (radius() - r) * (radius() + r)));
    if (shape == Shape::sphere) note(radius() - half), note(radius() + half);
    if (shape == Shape::frustum && ends[0] != ends[1]) note(Cone(*this).height(r, 0.0));
  }
  if (shape == Shape::frustum) note(height());
  std::sort(heights.begin(), heights.begin() + static_cast<std::ptrdiff_t>(count));
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < count; ++k) sum += integral(section_at, heights.at(k), heights.at(k + 1));
  return sum;
}

void Container::touching_planes(const Vec3& x, double range, const Found& found) const {
  if (is_mesh()) {
    interior->touches(x, range, deepest, [&](std::int32_t, const mesh::Touch& touch) {
      found({touch.normal[0], touch.normal[1], touch.normal[2]}, touch.distance);
    });
    return;
  }
  if (is_polygon()) {
    near_walls(x, range, [&](Surface wall, double distance) { found(facing(wall, x).normal, distance); });
    return;
  }
  for (std::size_t k = 0; k < most_round && !is_box(); ++k) {
    if (!has(static_cast<Surface>(most_planes + k))) continue;
    const RoundWall wall = round(k);
    const Facing nearest = wall.facing(x);
    if (nearest.distance > range) continue;
    if (wall.radial < 0.0) {
      found(nearest.normal, nearest.distance);
      continue;
    }
    Touching planes{wall, x, range, found};
    planes.begin(1e-12 * radius());
    if (wall.weight[2] > 0.0)
      planes.around_point();
    else
      planes.around_axis();
  }
}

}  // namespace packmpi::geometry
