// What a sphere touches of a surface: the local minima of the distance to it, each once.
#include <gtest/gtest.h>

#include "mesh/shapes.hpp"
#include "mesh/surface.hpp"

namespace packmpi::mesh {
namespace {

using testing::Dice;
using testing::Soup;

/// The nearest point of a triangle: its foot if that is inside, else of three segments.
Vec3 slow_nearest(const Corners& c, const Vec3& x) {
  const Vec3 n = unit(cross(minus(c[1], c[0]), minus(c[2], c[0])));
  bool inside = true;
  Vec3 best = c[0];
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = c.at(k), &b = c.at((k + 1) % 3);
    const Vec3 side = minus(b, a);
    inside = inside && dot(cross(side, minus(x, a)), n) >= 0.0;
    const Vec3 place = plus(a, times(std::clamp(dot(minus(x, a), side) / dot(side, side), 0.0, 1.0), side));
    if (norm(minus(x, place)) < norm(minus(x, best))) best = place;
  }
  return inside ? minus(x, times(dot(minus(x, c[0]), n), n)) : best;
}

/// Places of the surface nearer than `range` to which nothing around them is nearer.
std::vector<Vec3> slow_minima(const Soup& soup, const Vec3& x, double range) {
  std::vector<Vec3> found;
  for (const Corners& c : soup) {
    const Vec3 place = slow_nearest(c, x);
    const double distance = norm(minus(x, place));
    if (!(distance < range)) continue;
    const bool known = std::ranges::any_of(found, [&](const Vec3& y) { return norm(minus(y, place)) < 1e-9; });
    const bool least = std::ranges::all_of(soup, [&](const Corners& other) {
      const bool here = norm(minus(slow_nearest(other, place), place)) < 1e-10;
      return !here || norm(minus(slow_nearest(other, x), x)) > distance - 1e-10;
    });
    if (least && !known) found.push_back(place);
  }
  return found;
}

std::vector<Touch> touches(const Surface& surface, const Vec3& x, double range, double deepest) {
  NearFeatures near;
  surface.near(x, range, deepest, near);
  const Table table = surface.features().table(deepest);
  std::vector<Touch> found;
  for (std::size_t k = 0; k < near.feature.size(); ++k) {
    const Touch t =
        touch(table, near.feature[k], near.triangles.data(), near.begin(k), near.end[k], x.data(), far_away);
    const Touch alone = surface.touch_of(near.feature[k], x, deepest);
    if (t.distance < range) {
      EXPECT_EQ(alone.distance, t.distance);
      EXPECT_EQ(alone.normal[0], t.normal[0]);
      found.push_back(t);
    }
  }
  return found;
}

/// An interior around a cube, and what is around a house of edges: all kinds of corners.
Soup box_around_cube(int n) {
  Soup soup = testing::box({-2, -2, -2}, {2, 2, 2}, n);
  for (Corners c : testing::box({-0.5, -0.6, -0.7}, {0.6, 0.5, 0.4}, n)) {
    std::swap(c[1], c[2]);
    soup.push_back(c);
  }
  return soup;
}

TEST(Touch, IsEveryLocalMinimumOfTheDistance) {
  Dice dice(17);
  Soup ball_in_box = testing::box({-2, -2, -2}, {2, 2, 2});
  for (Corners c : testing::ball(2)) {
    std::swap(c[1], c[2]);
    ball_in_box.push_back(c);
  }
  const Soup turned = testing::moved(box_around_cube(3), [](const Vec3& x) { return testing::turned(x, 0.3, 0.9); });
  int touched = 0, several = 0;
  for (const Soup& soup : {testing::box({0, 0, 0}, {1, 1, 1}, 3), testing::l_prism(1.0, 2), testing::hopper(0.4, 2),
                           box_around_cube(1), turned, ball_in_box, testing::ball(2)}) {
    const Surface surface(soup, "a");
    for (int k = 0; k < 400; ++k) {
      const Vec3 x = dice.point(-2.0, 2.0);
      const double range = dice(0.1, 0.5);
      if (surface.nearest(x).distance < 1e-3) continue;
      const std::vector<Touch> found = touches(surface, x, range, 1e-3);
      std::vector<Vec3> expected = slow_minima(soup, x, range);
      EXPECT_EQ(found.size(), expected.size());
      for (const Touch& t : found) {
        const Vec3 place = plus(x, times(t.distance, {t.normal[0], t.normal[1], t.normal[2]}));
        EXPECT_EQ(std::erase_if(expected, [&](const Vec3& y) { return norm(minus(y, place)) < 1e-9; }), 1U);
      }
      touched += static_cast<int>(!found.empty());
      several += static_cast<int>(found.size() > 1);
    }
  }
  EXPECT_GT(touched, 300);
  EXPECT_GT(several, 50);
}

/// What pushes a sphere: the sum over its contacts.
Vec3 push(const Surface& surface, const Vec3& x, double r, std::size_t* count = nullptr) {
  Vec3 sum{};
  const auto all = touches(surface, x, r, 0.5 * r);
  for (const Touch& t : all) {
    const double deep = r - t.distance;
    for (std::size_t a = 0; a < 3; ++a) sum[a] -= deep * std::sqrt(deep) * t.normal[a];
  }
  if (count != nullptr) *count = all.size();
  return sum;
}

/// A plane of many triangles is one wall, wherever its seams are.
TEST(Touch, FeelsNoSeams) {
  Dice dice(19);
  const double a = 0.4, b = 1.1;
  const auto turn = [&](const Vec3& x) { return testing::turned(x, a, b); };
  const Surface one(testing::moved(testing::box({0, 0, 0}, {1, 1, 1}), turn), "a");
  const Surface many(testing::moved(testing::box({0, 0, 0}, {1, 1, 1}, 7), turn), "a");
  EXPECT_EQ(one.features().edge_begin(), 6);
  EXPECT_EQ(many.features().edge_begin(), 6);
  EXPECT_EQ(many.features().count(), 6);  // no edge and no corner sticks out
  for (int k = 0; k < 500; ++k) {
    Vec3 x = dice.point(0.01, 0.99);
    if (k % 3 == 0) x[std::size_t(k % 9) / 3] = dice(0.01, 0.1);
    if (k % 5 == 0) x[0] = double(k % 7) / 7.0 + 1e-3;  // above a seam or beside it
    std::size_t count = 0, count_of_one = 0;
    const Vec3 f = push(many, turn(x), 0.15, &count), g = push(one, turn(x), 0.15, &count_of_one);
    EXPECT_EQ(count, count_of_one);
    EXPECT_LT(norm(minus(f, g)), 1e-12);
  }
  std::size_t count = 0;
  for (int k = 0; k <= 70; ++k) {  // on seams and their crossings
    (void)push(many, turn({double(k) / 70.0 * 0.6 + 0.2, 3.0 / 7.0, 0.05}), 0.1, &count);
    EXPECT_EQ(count, 1U);
  }
}

/// Around edges and corners that stick out nothing jumps: each step changes the push by no more than its share.
TEST(Touch, IsContinuousAroundEdgesAndCorners) {
  const Surface surface(box_around_cube(2), "a");
  Dice dice(23);
  const double r = 0.3;
  double largest = 0.0;
  for (int path = 0; path < 6; ++path) {
    const Vec3 u = unit(dice.point(-1.0, 1.0)), v = unit(cross(u, dice.point(-1.0, 1.0)));
    Vec3 before{};
    const int steps = 2000;
    for (int k = 0; k <= steps; ++k) {
      const double angle = 2.0 * std::numbers::pi * k / steps;
      const Vec3 ray = plus(times(std::cos(angle), u), times(std::sin(angle), v));
      double low = 0.0, high = 1.7;  // the place on the ray that is 0.9 r away from the cube
      for (int turn = 0; turn < 40; ++turn) {
        const double middle = 0.5 * (low + high);
        const bool near = surface.distance(plus({0.05, -0.05, -0.15}, times(middle, ray)), 0.9 * r) < 0.9 * r;
        (near ? low : high) = middle;
      }
      std::size_t count = 0;
      const Vec3 now = push(surface, plus({0.05, -0.05, -0.15}, times(high, ray)), r, &count);
      EXPECT_EQ(count, 1U);
      if (k > 0) largest = std::max(largest, norm(minus(now, before)));
      before = now;
    }
  }
  const double whole = 0.1 * r * std::sqrt(0.1 * r);
  EXPECT_LT(largest,
            0.03 * whole);  // a two thousandth of a turn, and that is quicker around a corner: r / 10 away from it
}

TEST(Touch, IsNotFeltThroughThinWalls) {
  Soup soup = testing::box({0, 0, 0}, {1, 1, 1});
  for (Corners c : testing::box({0.48, 0.2, 0.2}, {0.5, 0.8, 0.8})) {  // a plate in the middle
    std::swap(c[1], c[2]);
    soup.push_back(c);
  }
  const Surface surface(soup, "a");
  std::size_t count = 0;
  const Vec3 f = push(surface, {0.39, 0.5, 0.5}, 0.1, &count);
  EXPECT_EQ(count, 1U);
  EXPECT_LT(f[0], 0.0);
  EXPECT_NEAR(f[0], -0.01 * 0.1, 1e-15);
}

}  // namespace
}  // namespace packmpi::mesh
