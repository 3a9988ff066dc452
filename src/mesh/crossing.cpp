// Does a surface cut itself? Pairs of triangles in the same cell of a grid.
#include <algorithm>
#include <cmath>

#include "mesh/grid.hpp"
#include "mesh/vectors.hpp"

namespace packmpi::mesh {
namespace {

// Signs of volumes in long double: of doubles that come from single precision they are exact but for the last bits.
using Wide = long double;

/// Six times the volume of the tetrahedron (a, b, c, d).
Wide six_volumes_of(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  std::array<Wide, 3> u{}, v{}, w{};
  for (std::size_t k = 0; k < 3; ++k) u[k] = Wide{b[k]} - a[k], v[k] = Wide{c[k]} - a[k], w[k] = Wide{d[k]} - a[k];
  return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/// Does the segment from p to q pass through the closed triangle, from one side of its plane to the other?
bool pierces(const Vec3& p, const Vec3& q, const Corners& t, double twice_area, double tolerance) {
  const Wide shallow = Wide{tolerance} * twice_area;
  const Wide at_p = six_volumes_of(t[0], t[1], t[2], p), at_q = six_volumes_of(t[0], t[1], t[2], q);
  if (!((at_p > shallow && at_q < -shallow) || (at_p < -shallow && at_q > shallow))) return false;
  const Wide a = six_volumes_of(p, q, t[0], t[1]), b = six_volumes_of(p, q, t[1], t[2]),
             c = six_volumes_of(p, q, t[2], t[0]);
  return (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
}

/// Twice the signed area of (a, b, c) seen along axis k.
double seen_area(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t k) {
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  return (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
}

bool holds_middle(const Corners& t, const Vec3& x, std::size_t axis, double small) {
  const double a = seen_area(t[0], t[1], x, axis), b = seen_area(t[1], t[2], x, axis),
               c = seen_area(t[2], t[0], x, axis);
  return (a > small && b > small && c > small) || (a < -small && b < -small && c < -small);
}

/// Of two triangles in one plane: do they overlap by more than their rims?
bool overlaps(const Corners& s, const Corners& t, const Vec3& normal, double small) {
  std::size_t axis = 0;
  for (std::size_t a = 1; a < 3; ++a) {
    if (std::abs(normal[a]) > std::abs(normal[axis])) axis = a;
  }
  const auto opposite = [&](double a, double b) { return (a > small && b < -small) || (a < -small && b > small); };
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &p = s.at(i), &q = s.at((i + 1) % 3);
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec3 &u = t.at(j), &v = t.at((j + 1) % 3);
      if (opposite(seen_area(p, q, u, axis), seen_area(p, q, v, axis)) &&
          opposite(seen_area(u, v, p, axis), seen_area(u, v, q, axis))) {
        return true;
      }
    }
  }
  const auto middle = [](const Corners& c) { return times(1.0 / 3.0, plus(c[0], plus(c[1], c[2]))); };
  return holds_middle(t, middle(s), axis, small) || holds_middle(s, middle(t), axis, small);
}

/// Private workings of first_crossing for one pair.
struct Pairs {
  const Shell* shell;

  [[nodiscard]] bool meet(std::size_t one, std::size_t other) const {
    const auto &p = shell->triangles[one], &q = shell->triangles[other];
    int shared = 0;
    for (const int point : p) shared += static_cast<int>(std::ranges::find(q, point) != q.end());
    const Corners s = shell->corners(one), t = shell->corners(other);
    if (apart(s, t)) return false;
    const bool thin_s = shell->is_needle(one), thin_t = shell->is_needle(other);
    const Vec3 n = shell->normal(one), m = shell->normal(other);
    const double area_s = norm(n), area_t = norm(m);
    if (shared >= 2) return !thin_s && !thin_t && dot(n, m) < -(1.0 - 1e-12) * area_s * area_t;
    const auto misses = [](const std::array<int, 3>& triangle, int a, int b) {
      return std::ranges::find(triangle, a) == triangle.end() && std::ranges::find(triangle, b) == triangle.end();
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (!thin_t && misses(q, p.at(k), p.at(next)) && pierces(s.at(k), s.at(next), t, area_t, shell->tolerance))
        return true;
      if (!thin_s && misses(p, q.at(k), q.at(next)) && pierces(t.at(k), t.at(next), s, area_s, shell->tolerance))
        return true;
    }
    return !thin_s && !thin_t && in_one_plane(s, t, m, area_t) &&
           overlaps(s, t, m, shell->tolerance * std::sqrt(area_t));
  }
  [[nodiscard]] static bool apart(const Corners& s, const Corners& t) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (std::max({s[0][a], s[1][a], s[2][a]}) < std::min({t[0][a], t[1][a], t[2][a]})) return true;
      if (std::max({t[0][a], t[1][a], t[2][a]}) < std::min({s[0][a], s[1][a], s[2][a]})) return true;
    }
    return false;
  }
  [[nodiscard]] bool in_one_plane(const Corners& s, const Corners& t, const Vec3& m, double area) const {
    return std::ranges::all_of(
        s, [&](const Vec3& x) { return std::abs(dot(m, minus(x, t[0]))) <= shell->tolerance * area; });
  }
};

}  // namespace

std::array<int, 2> first_crossing(const Shell& shell) {
  const Grid grid(shell);
  const Pairs pairs{&shell};
  std::array<int, 2> found{-1, -1};
  grid.each_cell([&](const int* first, const int* last) {
    for (const int* one = first; one < last && found[0] < 0; ++one) {
      for (const int* other = one + 1; other < last; ++other) {
        if (pairs.meet(static_cast<std::size_t>(*one), static_cast<std::size_t>(*other))) {
          found = {*one, *other};
          break;
        }
      }
    }
  });
  return found;
}

}  // namespace packmpi::mesh
