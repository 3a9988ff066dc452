// Volumes and sections of an interior, and of what spheres have in it.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "mesh/surface.hpp"
#include "mesh/vectors.hpp"

namespace packmpi::mesh {
namespace {

/// Of the part of a triangle below z = h: its area seen from above, positive where it looks up, and that times its mean
/// of z - h.
struct Below {
  double area = 0.0, moment = 0.0;

  void add(const Vec3& a, const Vec3& b, const Vec3& c, double h) {
    const double part = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    area += part;
    moment += part * (((a[2] - h) + (b[2] - h) + (c[2] - h)) / 3.0);
  }
  /// From a, below h, towards b, above it.
  static Vec3 at_height(const Vec3& a, const Vec3& b, double h) {
    return plus(a, times((h - a[2]) / (b[2] - a[2]), minus(b, a)));
  }
  void add_cut(const Corners& c, double h) {
    std::size_t first = 3, count = 0;  // corners below h: the one that the one before it is not
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(c.at(k)[2] < h)) continue;
      ++count;
      if (!(c.at((k + 2) % 3)[2] < h)) first = k;
    }
    if (count == 0) return;
    if (count == 3) return add(c[0], c[1], c[2], h);
    const Vec3 &a = c.at(first), &b = c.at((first + 1) % 3), &d = c.at((first + 2) % 3);
    if (count == 1) return add(a, at_height(a, b, h), at_height(a, d, h), h);
    const Vec3 after = at_height(b, d, h);
    add(a, b, after, h);
    add(a, after, at_height(a, d, h), h);
  }
};

/// A triangle's plane seen from a sphere's centre: sums over the part of the triangle that is inside the sphere.
struct Patch {
  double height;        // of the plane above the centre, along its normal
  double radius;        // of the sphere
  double disc;          // of the section
  double area = 0.0;    // of the triangle in it
  double corner = 0.0;  // the solid angle it is seen under, both positive if it goes anticlockwise about the normal

  /// The triangle from the foot of the centre, to the points a and b of the plane seen from there.
  void add(const Vec3& a, const Vec3& b, const Vec3& normal) {
    const double turn = dot(cross(a, b), normal);
    if (turn == 0.0) return;
    const Vec3 along = unit(minus(b, a));
    const double from = dot(a, along), to = dot(b, along);
    const double away = std::abs(turn) / norm(minus(b, a));  // of the line from the foot
    const double sign = turn > 0.0 ? 1.0 : -1.0;
    const double half = away < disc ? std::sqrt((disc - away) * (disc + away)) : 0.0;
    const double low = std::clamp(-half, from, to), high = std::clamp(half, from, to);
    sector(sign * (angle(low, away) - angle(from, away)));
    if (half > 0.0) wedge(sign, low, high, away);
    sector(sign * (angle(to, away) - angle(high, away)));
  }

 private:
  /// From the nearest point of the line on.
  static double angle(double along, double away) {
    const double a = angle_of(away, std::abs(along));
    return along < 0.0 ? -a : a;
  }
  /// Where the disc ends before the line: part of the disc.
  void sector(double turned) {
    area += 0.5 * disc * disc * turned;
    corner += turned * (1.0 - std::abs(height) / radius);
  }
  /// Where the line ends before the disc: a triangle. Its solid angle is its angle at the foot less that seen along the
  /// line: Girard's theorem.
  void wedge(double sign, double low, double high, double away) {
    area += sign * 0.5 * away * (high - low);
    const auto seen = [&](double along) {
      const double reach = std::sqrt(height * height + along * along + away * away);
      // The arc's length on the unit sphere above the foot, times the share that the plane's height takes of it.
      const double bent = angle_of(away * reach, std::abs(along) * std::abs(height));
      return along < 0.0 ? -bent : bent;
    };
    corner += sign * ((angle(high, away) - angle(low, away)) - (seen(high) - seen(low)));
  }
};

/// A polygon, and what of it is on the lower side of a plane across an axis.
std::vector<Vec3> clipped(const std::vector<Vec3>& polygon, std::size_t axis, double limit) {
  std::vector<Vec3> left;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Vec3 &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const bool first = a[axis] < limit, second = b[axis] < limit;
    if (first) left.push_back(a);
    if (first != second) {
      const Vec3 &low = first ? a : b, &high = first ? b : a;  // the same from both sides
      left.push_back(plus(low, times((limit - low[axis]) / (high[axis] - low[axis]), minus(high, low))));
    }
  }
  return left;
}

}  // namespace

// Caps need not be known: z - height is zero on that above, and that aside does not look up or down.
double Surface::volume_below(double height, std::size_t axis, double limit) const {
  Below below;
  for (std::size_t t = 0; t < shell_.triangles.size(); ++t) {
    const Corners c = shell_.corners(t);
    const std::vector<Vec3> part = clipped(clipped({c[0], c[1], c[2]}, axis, limit), 2, height);
    for (std::size_t k = 1; k + 1 < part.size(); ++k) below.add(part[0], part[k], part[k + 1], height);
  }
  return below.moment;
}

double Surface::volume_within(double margin, double low, double high) const {
  const double exact = volume_below(high) - volume_below(low);
  if (!(margin > 0.0)) return exact;
  constexpr int side = 48;
  const Vec3 size{shell_.high[0] - shell_.low[0], shell_.high[1] - shell_.low[1], high - low};
  std::int64_t inside = 0;
  for (int k = 0; k < side * side * side; ++k) {
    const std::array<int, 3> at{k % side, k / side % side, k / (side * side)};
    const auto place = [&](std::size_t a, double from) { return from + (at[a] + 0.5) / side * size[a]; };
    const Vec3 x{place(0, shell_.low[0]), place(1, shell_.low[1]), place(2, low)};
    inside += static_cast<int>(fits(x, margin));
  }
  return std::min(exact, static_cast<double>(inside) / (side * side * side) * size[0] * size[1] * size[2]);
}

bool Surface::meets_box(const Vec3& low, const Vec3& high) const {
  std::vector<int> near;
  grid_.in_box(low, high, near);
  return std::ranges::any_of(near, [&](int t) {
    const Corners c = shell_.corners(static_cast<std::size_t>(t));
    std::vector<Vec3> part{c[0], c[1], c[2]};
    for (std::size_t a = 0; a < 3; ++a) {
      part = clipped(part, a, high[a]);
      for (Vec3& x : part) x[a] = -x[a];
      part = clipped(part, a, -low[a]);
      for (Vec3& x : part) x[a] = -x[a];
    }
    return part.size() > 2;
  });
}

double Surface::walls_below(double height) const {
  double area = 0.0;
  for (std::size_t t = 0; t < shell_.triangles.size(); ++t) {
    if (std::abs(spot_[t].normal[2]) > 0.999) continue;
    const Corners c = shell_.corners(t);
    const std::vector<Vec3> part = clipped({c[0], c[1], c[2]}, 2, height);
    for (std::size_t k = 1; k + 1 < part.size(); ++k) {
      area += 0.5 * norm(cross(minus(part[k], part[0]), minus(part[k + 1], part[0])));
    }
  }
  return area;
}

double Surface::volume_below(double height) const {
  if (height <= shell_.low[2]) return 0.0;
  double sum = 0.0, rest = 0.0;  // Neumaier's
  for (std::size_t t = 0; t < shell_.triangles.size(); ++t) {
    Below below;
    below.add_cut(shell_.corners(t), height);
    const double next = sum + below.moment;
    rest += std::abs(sum) >= std::abs(below.moment) ? (sum - next) + below.moment : (below.moment - next) + sum;
    sum = next;
  }
  return sum + rest;
}

double Surface::area_at(double height) const {
  Below below;
  for (std::size_t t = 0; t < shell_.triangles.size(); ++t) below.add_cut(shell_.corners(t), height);
  return std::max(0.0, -below.area);
}

// Rays from the centre: each triangle bounds those that it is seen by, at its plane or at the sphere's surface.
double Surface::volume_of_sphere(const Vec3& x, double r) const {
  const double whole = 4.0 / 3.0 * std::numbers::pi * r * r * r;
  const double here = distance(x, r);
  if (here >= r) return whole;
  if (here <= -r) return 0.0;
  // On the surface a side has to be chosen: one that changes the volume by less than 1e-10 of r^3.
  const Vec3 centre = std::abs(here) < 1e-12 * r ? plus(x, times(2e-11 * r, Vec3{0.55, 0.6, 0.58})) : x;
  const bool inside = nearest(centre).distance > 0.0;
  std::vector<int> near;
  grid_.in_box({x[0] - r, x[1] - r, x[2] - r}, {x[0] + r, x[1] + r, x[2] + r}, near);
  double sum = inside ? whole : 0.0;
  for (const int t : near) {
    const Corners c = shell_.corners(static_cast<std::size_t>(t));
    const Vec3& n = spot_[static_cast<std::size_t>(t)].normal;
    const double height = dot(n, minus(c[0], centre));
    if (!(std::abs(height) < r)) continue;
    Patch patch{height, r, std::sqrt((r - height) * (r + height))};
    const Vec3 foot = plus(centre, times(height, n));
    for (std::size_t k = 0; k < 3; ++k) patch.add(minus(c.at(k), foot), minus(c.at((k + 1) % 3), foot), n);
    sum += height * patch.area / 3.0 - (height > 0.0 ? 1.0 : -1.0) * r * r * r * patch.corner / 3.0;
  }
  return std::clamp(sum, 0.0, whole);
}

}  // namespace packmpi::mesh
