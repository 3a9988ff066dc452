#include "mesh/bodies.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

#include "base/elementary.hpp"
#include "mesh/vectors.hpp"

namespace packmpi::mesh {
namespace {

/// cos and sin of k turns out of n, n a multiple of 4: of each quarter the same numbers.
std::array<double, 2> direction(int k, int n) {
  const int quarter = 4 * k / n, rest = k - quarter * n / 4;
  const double angle = 2.0 * std::numbers::pi * rest / n;
  const double c = elementary::cosine(angle), s = rest == 0 ? 0.0 : elementary::sine(angle);
  const std::array<std::array<double, 2>, 4> turned{{{c, s}, {-s, c}, {-c, -s}, {s, -c}}};
  return turned.at(static_cast<std::size_t>(quarter % 4));
}

double six_volumes(const Corners& c) { return dot(c[0], cross(c[1], c[2])); }

// A flat cap, its corners anticlockwise for who looks at it: strips across, as a fan's triangles would all be near each
// other in the middle.
void add_cap(std::vector<Corners>& triangles, const std::vector<Vec3>& ring) {
  for (std::size_t low = 0, high = ring.size() - 1; high - low >= 2;) {
    triangles.push_back({ring[low], ring[low + 1], ring[high]});
    if (++low + 2 > high) break;
    triangles.push_back({ring[low], ring[high - 1], ring[high]});
    --high;
  }
}

}  // namespace

std::array<Vec3, 2> box_around(const std::vector<Corners>& triangles) {
  Vec3 low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (const Corners& corners : triangles) {
    for (const Vec3& x : corners) {
      for (std::size_t a = 0; a < 3; ++a) low[a] = std::min(low[a], x[a]), high[a] = std::max(high[a], x[a]);
    }
  }
  return {low, high};
}

std::vector<Corners> prism_over(const std::vector<std::array<double, 2>>& polygon, double height) {
  const auto at = [&](std::size_t k, double z) {
    const auto& [x, y] = polygon[k % polygon.size()];
    return Vec3{x, y, z};
  };
  std::vector<Corners> triangles;
  for (std::size_t k = 1; k + 1 < polygon.size(); ++k) {
    triangles.push_back({at(0, 0.0), at(k + 1, 0.0), at(k, 0.0)});
    triangles.push_back({at(0, height), at(k, height), at(k + 1, height)});
  }
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    triangles.push_back({at(k, 0.0), at(k + 1, 0.0), at(k + 1, height)});
    triangles.push_back({at(k, 0.0), at(k + 1, height), at(k, height)});
  }
  return triangles;
}

std::vector<Corners> body_of_revolution(const Profile& profile, int facets) {
  const double angle = 2.0 * std::numbers::pi / facets;
  const double wider = std::sqrt(angle / elementary::sine(angle));  // for the area of a circle
  const auto at = [&](std::size_t p, int k) {
    const auto [c, s] = direction(k % facets, facets);
    const double rho = wider * profile[p][0];
    return Vec3{rho * c, rho * s, profile[p][1]};
  };
  const bool closed = profile.front()[0] > 0.0;
  std::vector<Corners> triangles;
  for (std::size_t p = 0; p + (closed ? 0 : 1) < profile.size(); ++p) {
    const std::size_t next = (p + 1) % profile.size();
    if (profile[p][1] == profile[next][1] && (profile[p][0] == 0.0 || profile[next][0] == 0.0)) {
      const bool from_axis = profile[p][0] == 0.0;  // a floor, which is seen from below
      std::vector<Vec3> ring(static_cast<std::size_t>(facets));
      for (int k = 0; k < facets; ++k) {
        ring[static_cast<std::size_t>(k)] = from_axis ? at(next, facets - k) : at(p, k);
      }
      add_cap(triangles, ring);
      continue;
    }
    for (int k = 0; k < facets; ++k) {
      if (profile[p][0] > 0.0) triangles.push_back({at(p, k), at(p, k + 1), at(next, k + 1)});
      if (profile[next][0] > 0.0) triangles.push_back({at(p, k), at(next, k + 1), at(next, k)});
    }
  }
  return triangles;
}

std::vector<Corners> sphere_of_facets(double radius) {
  Profile half;
  for (int k = 0; k <= rings; ++k) {
    const auto [down, out] = direction(k, 2 * rings);
    half.push_back({k == 0 || k == rings ? 0.0 : out, -down});
  }
  std::vector<Corners> triangles = body_of_revolution(half, around_sphere);
  double volume = 0.0;
  for (const Corners& c : triangles) volume += six_volumes(c) / 6.0;
  const double scale = radius * elementary::cube_root(4.0 / 3.0 * std::numbers::pi / volume);
  return moved(std::move(triangles), [&](const Vec3& x) { return times(scale, x); });
}

}  // namespace packmpi::mesh
