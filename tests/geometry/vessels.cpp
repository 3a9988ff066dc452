// Frusta, spheres and annuli: walls by looking for the nearest point of them, rooms and cut spheres by integrals of
// another kind, places drawn.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "geometry/container.hpp"
#include "geometry/cut_volume.hpp"
#include "geometry/round_volume.hpp"
#include "geometry/volume.hpp"

namespace packmpi::geometry {
namespace {

constexpr double round_pi = std::numbers::pi;

Container vessel(Shape shape, double widest, double height, std::array<double, 2> ends = {}, double core = 0.0) {
  Container made;
  made.size = {widest, widest, height};
  made.shape = shape;
  made.ends = ends;
  made.core = core;
  return made;
}
Container widening() { return vessel(Shape::frustum, 2.0, 1.5, {0.4, 1.0}); }
Container narrowing() { return vessel(Shape::frustum, 2.0, 1.5, {1.0, 0.4}); }
Container sphere() { return vessel(Shape::sphere, 2.0, 1.6); }
Container annulus() { return vessel(Shape::annulus, 2.0, 1.5, {}, 0.3); }
std::vector<Container> all_vessels() { return {widening(), narrowing(), sphere(), annulus()}; }

/// What is known of a wall without its formula: its radius by height, and between which heights it stands.
struct Meridian {
  Surface surface;
  std::function<double(double)> radius;
  double low, high;
};
std::vector<Meridian> meridians(const Container& v) {
  const double far = 8.0;
  const auto constant = [](double r) { return [r](double) { return r; }; };
  switch (v.shape) {
    case Shape::sphere:
      return {{Surface::mantle, [](double z) { return std::sqrt(std::max(0.0, z * (2.0 - z))); }, 0.0, 2.0}};
    case Shape::annulus:
      return {{Surface::mantle, constant(1.0), -far, far}, {Surface::inner, constant(0.3), -far, far}};
    default:
      if (v.closes()) return {{Surface::mantle, [](double z) { return 1.0 - 0.4 * z; }, -far, 2.5}};
      return {{Surface::mantle, [](double z) { return 0.4 + 0.4 * z; }, -1.0, far},
              {Surface::collar, constant(1.0), -far, far}};
  }
}

/// The nearest point of a meridian to (rho, z): thirds of an interval around the best of many.
double nearest(const Meridian& line, double rho, double z, double& at) {
  const auto square = [&](double h) {
    const double a = line.radius(h) - rho, b = h - z;
    return a * a + b * b;
  };
  double best = HUGE_VAL;
  constexpr int steps = 4000;
  const double step = (line.high - line.low) / steps;
  for (int k = 0; k <= steps; ++k) {
    const double h = line.low + k * step;
    if (square(h) < best) best = square(h), at = h;
  }
  double low = std::max(line.low, at - step), high = std::min(line.high, at + step);
  for (int turn = 0; turn < 120; ++turn) {
    const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
    (square(a) < square(b) ? high : low) = square(a) < square(b) ? b : a;
  }
  at = 0.5 * (low + high);
  return std::sqrt(square(at));
}

TEST(Vessels, FacingIsTheWayToTheNearestPointOfTheWall) {
  std::mt19937_64 engine(3);
  const auto dice = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1p-53);
  };
  for (const Container& v : all_vessels()) {
    for (const Meridian& line : meridians(v)) {
      ASSERT_TRUE(v.has(line.surface));
      for (int k = 0; k < 60; ++k) {
        const double z = dice(0.05, 1.5);
        const Ring ring = v.ring(z, 0.02);
        const double rho = dice(ring.inner, ring.outer), angle = dice(0.0, 2.0 * round_pi);
        const Vec3 x{1.0 + rho * std::cos(angle), 1.0 + rho * std::sin(angle), z};
        double at = 0.0;
        const double expected = nearest(line, rho, z, at);
        const Facing facing = v.facing(line.surface, x);
        EXPECT_NEAR(facing.distance, expected, 1e-9);
        EXPECT_NEAR(norm(facing.normal), 1.0, 1e-14);
        const Vec3 foot{x[0] + facing.distance * facing.normal[0], x[1] + facing.distance * facing.normal[1],
                        x[2] + facing.distance * facing.normal[2]};
        EXPECT_NEAR(std::hypot(foot[0] - 1.0, foot[1] - 1.0), line.radius(foot[2]), 1e-9);
      }
    }
  }
}

TEST(Vessels, HaveTheWallsThatTheyHave) {
  EXPECT_TRUE(widening().has(Surface::floor) && widening().has(Surface::collar));
  EXPECT_FALSE(narrowing().has(Surface::collar));
  EXPECT_FALSE(sphere().has(Surface::floor));  // its lowest point would touch twice
  EXPECT_FALSE(sphere().has(Surface::inner) || annulus().has(Surface::collar));
  EXPECT_TRUE(narrowing().closes() && sphere().closes());
  EXPECT_FALSE(widening().closes() || annulus().closes() || widening().straight() || !annulus().straight());
  for (const Container& v : all_vessels()) {
    for (std::size_t wall = 1; wall < most_planes; ++wall) EXPECT_FALSE(v.has(static_cast<Surface>(wall)));
    EXPECT_LT(v.beyond({1.5, 1.0, 0.9}), 0.0);
    EXPECT_GT(v.beyond({2.1, 1.0, 0.9}), 0.0);
    EXPECT_TRUE(std::isnan(v.beyond({std::nan(""), 1.0, 0.5})));
  }
  EXPECT_NEAR(annulus().beyond({1.1, 1.0, 0.5}), 0.2, 1e-15);
  EXPECT_NEAR(sphere().beyond({1.0, 1.0, -0.25}), 0.25, 1e-15);
}

/// Double exponential quadrature: ends with powers of a half are no trouble.
double quadrature(const std::function<double(double)>& f, double a, double b) {
  double sum = 0.0;
  constexpr double h = 1.0 / 64.0;
  for (int k = -256; k <= 256; ++k) {
    const double t = k * h, s = 0.5 * round_pi * std::sinh(t), c = std::cosh(s);
    sum += 0.5 * round_pi * std::cosh(t) / (c * c) * f(0.5 * (a + b) + 0.5 * (b - a) * std::tanh(s));
  }
  return 0.5 * (b - a) * h * sum;
}

/// In pieces, between heights at which a state changes, found by halving.
double piecewise(const std::function<double(double)>& f, const std::function<int(double)>& state, double a, double b) {
  std::vector<double> ends{a};
  constexpr int looks = 400;
  for (int k = 0; k < looks; ++k) {
    double low = a + (b - a) * (k + 0.01) / looks, high = a + (b - a) * (k + 1.01) / looks;
    if (high > b || state(low) == state(high)) continue;
    for (int turn = 0; turn < 60; ++turn) {
      const double middle = 0.5 * (low + high);
      (state(middle) == state(low) ? low : high) = middle;
    }
    ends.push_back(low);
  }
  ends.push_back(b);
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < ends.size(); ++k) sum += quadrature(f, ends[k], ends[k + 1]);
  return sum;
}

/// Radii between which points of a height are `margin` away from all walls: by looking along a radius.
double area_away(const Container& v, double z, double margin) {
  const auto away = [&](double rho) { return v.from_sides({1.0 + rho, 1.0, z}) - margin; };
  double best = 0.0;
  for (double rho = 0.0; rho < 1.05; rho += 0.025) best = away(rho) > away(best) ? rho : best;
  if (!(away(best) > 0.0)) return 0.0;
  const auto edge = [&](double inside, double outside) {
    if (away(outside) > 0.0) return outside;
    for (int turn = 0; turn < 60; ++turn) {
      const double middle = 0.5 * (inside + outside);
      (away(middle) > 0.0 ? inside : outside) = middle;
    }
    return inside;
  };
  const double inner = edge(best, 0.0), outer = edge(best, 1.1);
  return round_pi * (outer * outer - inner * inner);
}

TEST(Vessels, RoomsAreTheIntegralsOfTheirSections) {
  for (const Container& v : all_vessels()) {
    for (const double margin : {0.0, 0.13}) {
      for (const auto& [low, high] : {std::pair(0.0, 1.5), std::pair(0.3, 0.9), std::pair(1.2, 1.9)}) {
        const auto area = [&](double z) { return area_away(v, z, margin); };
        const auto state = [&](double z) {  // is there any, and which wall bounds it?
          const Vec3 x{1.0 + std::sqrt(area(z) / round_pi), 1.0, z};
          const bool above = v.has(Surface::collar) && v.facing(Surface::collar, x).distance < margin + 1e-7;
          return (area(z) > 0.0 ? 1 : 0) + (above ? 2 : 0);
        };
        EXPECT_NEAR(v.volume_within(margin, low, high), piecewise(area, state, low, high), 1e-9);
      }
    }
    EXPECT_NEAR(v.area_at(0.7), area_away(v, 0.7, 0.0), 1e-9);
    EXPECT_NEAR(v.volume_between(0.2, 1.1), v.volume_within(0.0, 0.2, 1.1), 1e-15);
    EXPECT_NEAR(v.mean_area(0.2, 0.9), v.volume_between(0.2, 1.1) / 0.9, 1e-15);
    for (const double z : {0.1, 0.8, 1.5}) EXPECT_NEAR(v.level(v.volume_between(0.0, z)), z, 1e-12);
  }
  EXPECT_NEAR(widening().level(widening().volume_between(0.0, 3.0)), 3.0, 1e-12);
  EXPECT_NEAR(sphere().volume_between(0.0, 2.0), 4.0 / 3.0 * round_pi, 1e-15);
  EXPECT_NEAR(sphere().level(99.0), 2.0, 1e-15);
  EXPECT_NEAR(narrowing().level(99.0), 2.5, 1e-15);  // the tip
  const double slant = std::hypot(1.5, 0.6);
  EXPECT_NEAR(widening().wall_area(1.5), round_pi * 1.4 * slant, 1e-14);
  EXPECT_NEAR(widening().wall_area(2.0), round_pi * 1.4 * slant + round_pi, 1e-14);
  EXPECT_NEAR(narrowing().wall_area(1.5), round_pi * 1.4 * slant, 1e-14);
  EXPECT_NEAR(sphere().wall_area(2.0), 4.0 * round_pi, 1e-14);
  EXPECT_NEAR(annulus().wall_area(1.0), 2.6 * round_pi, 1e-14);
}

/// What two discs have in common, by the textbook; and whether they cut each other.
double two_discs(double s, double t, double b) {
  if (!(s > 0.0 && t > 0.0) || b >= s + t) return 0.0;
  if (b <= std::abs(s - t)) return round_pi * std::min(s, t) * std::min(s, t);
  const double first = std::acos(std::clamp((b * b + s * s - t * t) / (2.0 * b * s), -1.0, 1.0));
  const double second = std::acos(std::clamp((b * b + t * t - s * s) / (2.0 * b * t), -1.0, 1.0));
  return s * s * (first - 0.5 * std::sin(2.0 * first)) + t * t * (second - 0.5 * std::sin(2.0 * second));
}
int state_of(double s, double t, double b) {
  if (!(t > 0.0) || b >= s + t) return 0;
  return b > std::abs(s - t) ? 1 : s < t ? 2 : 3;
}

TEST(Vessels, CutSpheresToABillionth) {
  std::mt19937_64 engine(11);
  const auto dice = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1p-53);
  };
  int cut = 0;
  for (int k = 0; k < 60; ++k) {
    const double r = 1.0, b = dice(0.0, 4.0), low = dice(-1.1, 0.2), high = dice(low, 1.1);
    const double from = std::max(low, -r), to = std::min(high, r);
    const double rise = dice(-1.5, 1.5), wide = std::max(0.1, b + dice(-1.2, 1.2)), up = dice(-1.0, 1.0);
    const auto own = [&](double z) { return std::sqrt(std::max(0.0, r * r - z * z)); };
    const auto cone = [&](double z) { return wide + rise * z; };
    const auto ball = [&](double z) { return std::sqrt(std::max(0.0, wide * wide - (z - up) * (z - up))); };
    const auto slow = [&](const std::function<double(double)>& other) {
      return piecewise([&](double z) { return two_discs(own(z), other(z), b); },
                       [&](double z) { return state_of(own(z), other(z), b); }, from, to);
    };
    const double in_cone = volume_in_cone(r, b, wide, rise, low, high);
    EXPECT_NEAR(in_cone, slow(cone), 1e-9) << b << ' ' << wide << ' ' << rise << ' ' << low << ' ' << high;
    EXPECT_NEAR(volume_in_ball(r, b, up, wide, low, high), slow(ball), 1e-9) << b << ' ' << wide << ' ' << up;
    const double whole = volume_below(3, r, 0.0, high) - volume_below(3, r, 0.0, low);
    cut += in_cone > 1e-3 && in_cone < whole - 1e-3 ? 1 : 0;
    EXPECT_NEAR(volume_in_ball(r, b, up, wide, -HUGE_VAL, HUGE_VAL), volume_in_sphere(r, std::hypot(b, up), wide),
                1e-9);
    EXPECT_NEAR(volume_in_cone(r, b, wide, 0.0, low, high), volume_in_cylinder(r, b, wide, low, high), 1e-9);
  }
  EXPECT_GT(cut, 15);
}

TEST(Vessels, SpheresAwayFromAWallAreThoseOfTheOffsetWall) {
  for (const Container& v : all_vessels()) {
    for (const Meridian& line : meridians(v)) {
      const Vec3 x{1.45, 1.2, 0.6};
      const double r = 0.2, away = v.facing(line.surface, x).distance;
      const auto volume_at = [&](double margin) { return volume_away_from(v, line.surface, margin, x, r, 0.5, 0.75); };
      const double whole = volume_below(3, r, x[2], 0.75) - volume_below(3, r, x[2], 0.5);
      EXPECT_NEAR(volume_at(away - 1.01 * r), whole, 1e-12);
      EXPECT_NEAR(volume_at(away + 1.01 * r), 0.0, 1e-12);
      EXPECT_GT(volume_at(away - 0.1 * r), volume_at(away + 0.1 * r));
      const double half = volume_away_from(v, line.surface, away, x, r, -9.0, 9.0) / volume(3, r);
      EXPECT_NEAR(half, 0.5, 0.2);  // a plane would halve it
    }
  }
}

/// As many in each of equal parts: by the share of the interior below, by that of the ring's area, by quarters.
TEST(Vessels, PlacesAreDrawnEvenlyOverTheRoom) {
  const double radius = 0.1, low = 0.1, thickness = 1.3;
  constexpr int side = 24;
  for (const Container& v : all_vessels()) {
    std::array<int, 64> counts{};
    const double interior = v.volume_within(radius, low + radius, low + thickness - radius);
    for (int k = 0; k < side * side * side; ++k) {
      const int layer = k / (side * side), line = k / side % side;
      const Vec3 x =
          v.draw({(k % side + 0.5) / side, (line + 0.5) / side, (layer + 0.5) / side}, radius, low, thickness);
      ASSERT_TRUE(v.holds(x, radius - 1e-12));
      ASSERT_GE(x[2], low + radius - 1e-12);
      ASSERT_LE(x[2], low + thickness - radius + 1e-12);
      const double below = v.volume_within(radius, low + radius, x[2]) / interior;
      const Ring ring = v.ring(x[2], radius);
      const double rho = std::hypot(x[0] - 1.0, x[1] - 1.0), inner = ring.inner * ring.inner;
      const double share = (rho * rho - inner) / (ring.outer * ring.outer - inner);
      const int quarter = (x[0] > 1.0 ? 1 : 0) + (x[1] > 1.0 ? 2 : 0);
      ++counts.at(static_cast<std::size_t>(16 * std::min(3, static_cast<int>(4.0 * below)) +
                                           4 * std::min(3, static_cast<int>(4.0 * share)) + quarter));
    }
    for (const int count : counts) EXPECT_EQ(count, side * side * side / 64);
  }
}

TEST(Vessels, SlabsAddUpAndAreSums) {
  for (const Container& v : all_vessels()) {
    const double low = 0.25, high = 1.3;
    double sum = 0.0;
    for (int k = 0; k < 20; ++k) sum += v.slab(0, 0.1 * k, 0.1 * (k + 1), low, high);
    EXPECT_NEAR(sum, v.volume_between(low, high), 1e-9);
    constexpr int steps = 400;
    double slow = 0.0;  // of points
    for (int k = 0; k < steps * steps; ++k) {
      const double z = low + (high - low) * (k / steps + 0.5) / steps, x = 1.2 + 0.3 * (k % steps + 0.5) / steps;
      const Ring ring = v.ring(z, 0.0);
      const auto chord = [&](double r) { return 2.0 * std::sqrt(std::max(0.0, r * r - (x - 1.0) * (x - 1.0))); };
      slow += chord(ring.outer) - chord(ring.inner);
    }
    EXPECT_NEAR(v.slab(1, 1.2, 1.5, low, high), slow * 0.3 * (high - low) / (steps * steps), 2e-4);
  }
}

TEST(Vessels, PlanesTouchThemFromOutside) {
  for (const Container& v : all_vessels()) {
    const Vec3 x{1.5, 1.1, 0.8};
    int planes = 0;
    double nearest_plane = HUGE_VAL;
    v.touching_planes(x, 0.6, [&](const Vec3& n, double away) {
      ++planes;
      nearest_plane = std::min(nearest_plane, away);
      EXPECT_NEAR(norm(n), 1.0, 1e-14);
      EXPECT_LE(away, 0.6);
      if (n[0] * (x[0] - 1.0) + n[1] * (x[1] - 1.0) < 0.0 && v.shape == Shape::annulus) return;  // of the inner wall
      double least = HUGE_VAL;  // from points inside to the plane
      for (int k = 0; k < 64 * 64; ++k) {
        const double z = 0.05 + 1.4 * (k / 64) / 64.0, angle = 2.0 * round_pi * (k % 64) / 64.0;
        const double rho = v.ring(z, 0.0).outer;
        const Vec3 d{1.0 + rho * std::cos(angle) - x[0], 1.0 + rho * std::sin(angle) - x[1], z - x[2]};
        least = std::min(least, away - (n[0] * d[0] + n[1] * d[1] + n[2] * d[2]));
      }
      EXPECT_GE(least, -1e-12);
    });
    EXPECT_GT(planes, 10);
    EXPECT_NEAR(nearest_plane, v.from_sides(x), 1e-12);
  }
}

}  // namespace
}  // namespace packmpi::geometry
