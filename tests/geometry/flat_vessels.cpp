// Vessels in 2D: rooms and cut discs by integrals of another kind, places drawn.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "geometry/container.hpp"
#include "geometry/cut_volume.hpp"
#include "geometry/polygon.hpp"
#include "geometry/round_volume.hpp"
#include "geometry/volume.hpp"

namespace packmpi::geometry {
namespace {

Container circle() {
  Container made;
  made.dimension = 2;
  made.size = {2.0, 1.6, 0.0};
  made.shape = Shape::sphere;
  return made;
}

/// Area of where `interior` is positive, by lines along z whose ends are found by halving.
double area_by_lines(const std::function<double(double, double)>& interior, double from, double to, double low,
                     double high, int lines) {
  double sum = 0.0;
  for (int k = 0; k < lines; ++k) {
    const double x = from + (to - from) * (k + 0.5) / lines;
    constexpr int looks = 64;
    const auto z_of = [&](double n) { return low + (high - low) * n / looks; };
    for (int n = 0; n < looks; ++n) {
      double a = z_of(n), b = z_of(n + 1);
      const bool first = interior(x, a) > 0.0, second = interior(x, b) > 0.0;
      if (first && second) sum += b - a;
      if (first == second) continue;
      const double end = first ? a : b;
      for (int turn = 0; turn < 50; ++turn) {
        const double middle = 0.5 * (a + b);
        (interior(x, middle) > 0.0) == first ? a = middle : b = middle;
      }
      sum += std::abs(a - end);
    }
  }
  return sum * (to - from) / lines;
}

TEST(Circle, HasOneWallAroundIt) {
  const Container v = circle();
  EXPECT_TRUE(v.has(Surface::mantle) && v.closes() && !v.straight());
  for (std::size_t wall = 0; wall < most_surfaces; ++wall)
    EXPECT_EQ(v.has(static_cast<Surface>(wall)), wall == most_planes);
  const Facing facing = v.facing(Surface::mantle, {1.3, 0.6, 0.0});
  EXPECT_NEAR(facing.distance, 0.5, 1e-15);
  EXPECT_NEAR(facing.normal[0], 0.6, 1e-15);
  EXPECT_NEAR(facing.normal[1], -0.8, 1e-15);
  EXPECT_EQ(facing.normal[2], 0.0);
  EXPECT_NEAR(v.beyond({1.0, -0.25, 0.0}), 0.25, 1e-15);
  EXPECT_TRUE(v.holds({1.3, 0.6, 0.0}, 0.499) && !v.holds({1.3, 0.6, 0.0}, 0.501));
}

TEST(Circle, ItsRoomIsThatOfSegments) {
  const Container v = circle();
  const auto interior = [&](double margin) {
    return [&v, margin](double x, double z) { return v.from_sides({x, z, 0.0}) - margin; };
  };
  EXPECT_NEAR(v.volume_between(0.0, 2.0), std::numbers::pi, 1e-15);
  EXPECT_NEAR(v.volume_between(0.0, 1.0), 0.5 * std::numbers::pi, 1e-15);
  EXPECT_NEAR(v.area_at(0.4), 1.6, 1e-15);  // a chord
  EXPECT_NEAR(v.wall_area(2.0), 2.0 * std::numbers::pi, 1e-14);
  EXPECT_NEAR(v.wall_area(0.5), 2.0 / 3.0 * std::numbers::pi, 1e-14);  // 60 degrees to both sides of its lowest point
  for (const double margin : {0.0, 0.13}) {
    const double area = area_by_lines(interior(margin), 0.0, 2.0, 0.3, 1.4, 4000);
    EXPECT_NEAR(v.volume_within(margin, 0.3, 1.4), area, 1e-5);
  }
  const double slab = area_by_lines(interior(0.0), 0.2, 0.7, 0.3, 1.4, 4000);
  EXPECT_NEAR(v.slab(0, 0.2, 0.7, 0.3, 1.4), slab, 1e-6);
  EXPECT_NEAR(v.slab(0, 0.0, 2.0, 0.3, 1.4), v.volume_between(0.3, 1.4), 1e-14);
  for (const double z : {0.1, 0.8, 1.5}) EXPECT_NEAR(v.level(v.volume_between(0.0, z)), z, 1e-12);
  EXPECT_NEAR(v.level(99.0), 2.0, 1e-15);
}

/// Places for discs of radius 0.1 in the layer between two heights.
void expect_even_places(const Container& v, double low, double high) {
  std::mt19937_64 engine(5);
  const auto dice = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
  const double r = 0.1;
  constexpr int draws = 40000;
  std::array<int, 4> counts{};  // left and right of x = 0.8, below and above z = 0.9
  for (int k = 0; k < draws; ++k) {
    const Vec3 x = v.draw({dice(), dice(), dice()}, r, low, high - low);
    ASSERT_GE(v.from_sides(x), r - 1e-12);
    ASSERT_TRUE(x[1] >= low + r - 1e-15 && x[1] <= high - r + 1e-15 && x[2] == 0.0);
    ++counts.at((x[0] < 0.8 ? 0U : 1U) + (x[1] < 0.9 ? 0U : 2U));
  }
  const double all = v.volume_within(r, low + r, high - r);
  const auto share = [&](double from, double to, double a, double b) {
    const auto interior = [&](double x, double z) { return v.from_sides({x, z, 0.0}) - r; };
    return area_by_lines(interior, from, to, a, b, 2000) / all;
  };
  const double bottom = low + r, top = high - r;
  const std::array<double, 4> wanted{share(0.0, 0.8, bottom, 0.9), share(0.8, 2.0, bottom, 0.9),
                                     share(0.0, 0.8, 0.9, top), share(0.8, 2.0, 0.9, top)};
  for (std::size_t k = 0; k < 4; ++k) {
    const double sd = std::sqrt(draws * wanted[k] * (1.0 - wanted[k]));
    EXPECT_NEAR(counts[k], draws * wanted[k], 4.5 * sd) << k;
  }
}

TEST(Circle, PlacesAreDrawnEvenly) { expect_even_places(circle(), 0.2, 1.5); }

/// What two discs have in common, by the textbook.
double lens_of(double s, double t, double b) {
  if (b >= s + t) return 0.0;
  if (b <= std::abs(s - t)) return std::numbers::pi * std::min(s, t) * std::min(s, t);
  const double first = std::acos((b * b + s * s - t * t) / (2.0 * b * s));
  const double second = std::acos((b * b + t * t - s * s) / (2.0 * b * t));
  return s * s * (first - 0.5 * std::sin(2.0 * first)) + t * t * (second - 0.5 * std::sin(2.0 * second));
}

TEST(Circle, CutsDiscsToABillionth) {
  const Container v = circle();
  std::mt19937_64 engine(11);
  const auto dice = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1p-53);
  };
  int cut = 0;
  for (int k = 0; k < 400; ++k) {
    const double r = dice(0.01, 0.4), margin = dice(0.0, 0.6);
    const Vec3 x{dice(0.1, 1.9), dice(0.1, 1.9), 0.0};
    const double b = std::hypot(x[0] - 1.0, x[1] - 1.0), inside = lens_of(r, 1.0 - margin, b);
    const auto away = [&](double low, double high) {
      return volume_away_from(v, Surface::mantle, margin, x, r, low, high);
    };
    EXPECT_NEAR(away(-9.0, 9.0), inside, 1e-9 * r * r) << k;
    const double between = x[1] + dice(-r, r);
    EXPECT_NEAR(away(-9.0, between) + away(between, 9.0), inside, 1e-9 * r * r) << k;
    if (inside > 0.0 && inside < 0.99 * volume(2, r)) ++cut;
    if (inside > 0.999999 * volume(2, r)) {
      EXPECT_NEAR(away(-9.0, between), volume_below(2, r, x[1], between), 1e-9 * r * r);
    }
  }
  EXPECT_GT(cut, 40);
}

Container in_polygon(const Polygon& polygon, double height) {
  Container made;
  made.dimension = 2;
  made.size = {polygon.width(), height, 0.0};
  made.shape = Shape::polygon;
  made.polygon = &polygon;
  return made;
}
const Polygon& widening() {
  static const Polygon one(0.8, 2.0, 1.5);
  return one;
}
const Polygon& narrowing() {
  static const Polygon one(2.0, 0.8, 1.5);
  return one;
}
/// A floor, an upright side, and three that slope.
const Polygon& house() {
  static const Polygon one(Corners{{0.3, 0.0}, {1.4, 0.0}, {2.0, 0.7}, {1.1, 1.8}, {0.0, 1.2}, {0.0, 0.4}});
  return one;
}
const std::array<const Polygon*, 3>& polygons() {
  static const std::array<const Polygon*, 3> all{&widening(), &narrowing(), &house()};
  return all;
}

TEST(Polygons, HaveTheWallsThatTheyHave) {
  EXPECT_TRUE(widening().has_plane(0) && widening().has_plane(1) && widening().has_plane(2));
  EXPECT_TRUE(narrowing().has_plane(0) && !narrowing().has_plane(1) && !narrowing().has_plane(2));
  EXPECT_TRUE(house().has_plane(0) && house().has_plane(1) && !house().has_plane(2));
  EXPECT_EQ(widening().sloping().size(), 2U);
  EXPECT_EQ(narrowing().sloping().size(), 2U);
  EXPECT_EQ(house().sloping().size(), 4U);
  EXPECT_EQ(widening().top(), HUGE_VAL);
  EXPECT_NEAR(narrowing().top(), 2.5, 1e-14);
  EXPECT_EQ(house().top(), 1.8);
  const Container v = in_polygon(house(), 1.5);
  EXPECT_TRUE(v.has(Surface::floor) && v.has(Surface::x_low) && !v.has(Surface::x_high) && v.closes());
  EXPECT_FALSE(in_polygon(widening(), 1.5).closes());
  const auto sloping = [&](std::size_t k) { return static_cast<Surface>(most_surfaces + k); };
  EXPECT_TRUE(v.has(sloping(3)) && !v.has(sloping(4)) && !v.has(Surface::mantle));
  // The side from (2.0, 0.7) to (1.1, 1.8): by the definition.
  const Vec3 x{1.2, 0.6, 0.0};
  const Facing facing = v.facing(sloping(1), x);
  const double length = std::hypot(0.9, 1.1);
  EXPECT_NEAR(facing.distance, std::abs(0.9 * (x[1] - 0.7) + 1.1 * (x[0] - 2.0)) / length, 1e-15);
  EXPECT_NEAR(facing.normal[0], 1.1 / length, 1e-15);
  EXPECT_NEAR(facing.normal[1], 0.9 / length, 1e-15);
  std::vector<std::size_t> found;
  v.near_walls({0.3, 0.2, 0.0}, 0.35, [&](Surface wall, double) { found.push_back(static_cast<std::size_t>(wall)); });
  EXPECT_EQ(found, (std::vector<std::size_t>{0, 1, most_surfaces + 3}));
  EXPECT_NEAR(v.beyond({0.5, -0.25, 0.0}), 0.25, 1e-15);
  EXPECT_TRUE(std::isnan(v.beyond({std::nan(""), 0.5, 0.0})));
}

TEST(Polygons, RoomsAreWhatIsInsideTheirSides) {
  for (const Polygon* polygon : polygons()) {
    const Container v = in_polygon(*polygon, 1.5);
    for (const double margin : {0.0, 0.13}) {
      const auto interior = [&](double x, double z) { return v.from_sides({x, z, 0.0}) - margin; };
      for (const auto& [low, high] : {std::pair(0.05, 1.5), std::pair(0.3, 0.9), std::pair(1.2, 2.1)}) {
        EXPECT_NEAR(v.volume_within(margin, low, high), area_by_lines(interior, 0.0, 2.0, low, high, 4000), 2e-4);
      }
      if (margin > 0.0) continue;
      EXPECT_NEAR(v.slab(0, 0.2, 0.7, 0.3, 1.4), area_by_lines(interior, 0.2, 0.7, 0.3, 1.4, 4000), 1e-6);
    }
    for (const double z : {0.1, 0.8, 1.5}) {
      EXPECT_NEAR(v.level(v.volume_between(0.0, z)), z, 1e-12);
      EXPECT_NEAR(v.area_at(z), (v.volume_between(z - 1e-5, z + 1e-5)) / 2e-5, 1e-5);
    }
  }
  EXPECT_NEAR(in_polygon(widening(), 1.5).volume_between(0.0, 2.5), 1.4 * 1.5 + 2.0, 1e-14);
  EXPECT_NEAR(in_polygon(widening(), 1.5).level(4.1), 2.5, 1e-14);
  EXPECT_NEAR(in_polygon(narrowing(), 1.5).volume_between(0.0, 9.0), 2.5, 1e-14);
  EXPECT_NEAR(in_polygon(narrowing(), 1.5).level(99.0), 2.5, 1e-14);
  EXPECT_NEAR(in_polygon(widening(), 1.5).wall_area(2.0), 2.0 * std::hypot(1.5, 0.6) + 1.0, 1e-14);
  EXPECT_NEAR(in_polygon(narrowing(), 1.5).wall_area(1.5), 2.0 * std::hypot(1.5, 0.6), 1e-14);
  const double around = std::hypot(0.6, 0.7) + std::hypot(0.9, 1.1) + std::hypot(1.1, 0.6) + 0.8 + std::hypot(0.3, 0.4);
  EXPECT_NEAR(in_polygon(house(), 1.5).wall_area(1.8), around, 1e-14);
}

TEST(Polygons, PlacesAreDrawnEvenly) {
  for (const Polygon* polygon : polygons()) expect_even_places(in_polygon(*polygon, 1.5), 0.2, 1.5);
  const Vec3 none = in_polygon(narrowing(), 1.5).draw({0.5, 0.5, 0.5}, 0.1, 2.2, 0.5);  // too near to its tip
  EXPECT_TRUE(std::isnan(none[2]));
}

// The sum over a fan of triangles does not know where the middle is; a disc in a half plane is a segment, in a quarter
// that of a rectangle; and parts add up.
TEST(Polygons, CutDiscsToABillionth) {
  std::mt19937_64 engine(7);
  const auto dice = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1p-53);
  };
  int cut = 0;
  for (int k = 0; k < 400; ++k) {
    const double r = dice(0.01, 0.5);
    const Vec3 x{dice(-0.2, 2.2), dice(-0.2, 2.0), 0.0};
    const double place = dice(0.1, 1.9), height = dice(0.1, 1.7), square = r * r;
    const Corners lower{{0.0, 0.0}, {2.0, 0.0}, {2.0, height}, {0.0, height}};
    const Vec3 low{-x[0], -x[1], 0.0}, high{2.0 - x[0], height - x[1], 0.0};
    EXPECT_NEAR(area_in_polygon(r, x, lower), area_in_rectangle(r, low, high), 1e-9 * square) << k;
    const Container v = in_polygon(house(), 1.5);
    const double whole = area_in_polygon(r, x, house().within(0.0, 0.0, 1.8));
    double parts = 0.0;
    for (const auto& [from, to] : {std::pair(0.0, place), std::pair(place, 2.0)}) {
      for (const auto& [bottom, top] : {std::pair(0.0, height), std::pair(height, 1.8)})
        parts += area_in_polygon(r, x, house().within(0.0, bottom, top, from, to));
    }
    EXPECT_NEAR(parts, whole, 1e-9 * square) << k;
    const auto interior = [&](double a, double b) {
      const Vec3 at{a, b, 0.0};
      const double across = std::hypot(a - x[0], b - x[1]);
      return std::min(-v.beyond(at), r - across);
    };
    if (k < 20) {
      EXPECT_NEAR(whole, area_by_lines(interior, x[0] - r, x[0] + r, x[1] - r, x[1] + r, 2000), 2e-3 * square);
    }
    if (whole > 0.0 && whole < 0.99 * volume(2, r)) ++cut;
    if (interior(x[0], x[1]) >= r) {
      EXPECT_NEAR(whole, volume(2, r), 1e-13 * square);
    }
    EXPECT_NEAR(volume_away_from(v, Surface::mantle, 0.1, x, r, 0.2, 1.4),
                area_in_polygon(r, x, house().within(0.1, 0.2, 1.4)), 1e-15);
  }
  EXPECT_GT(cut, 100);
}

}  // namespace
}  // namespace packmpi::geometry
