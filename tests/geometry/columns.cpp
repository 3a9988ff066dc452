// Columns against brute force over all pairs of them and over sampled points.
#include "geometry/columns.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <vector>

namespace packmpi::geometry {
namespace {

Container box3(double lx, double ly, bool px, bool py) { return {3, {lx, ly, 1.0}, {px, py}}; }
Container box2(double lx, bool px) { return {2, {lx, 1.0, 0.0}, {px, false}}; }

std::vector<Container> boxes() {
  std::vector<Container> all;
  for (const bool px : {false, true}) {
    for (const bool py : {false, true}) {
      all.push_back(box3(3.0, 3.0, px, py));
      all.push_back(box3(5.5, 3.2, px, py));
      all.push_back(box3(7.9, 4.0, px, py));
    }
    all.push_back(box2(3.0, px));
    all.push_back(box2(6.3, px));
  }
  all.push_back(box3(0.4, 5.0, false, true));  // narrower than the reach: one column
  all.push_back(box3(2.5, 1.5, false, false));
  return all;
}

TEST(Wrap, PutsOnePeriodAwayBackInside) {
  EXPECT_EQ(wrap(0.25, 2.0), 0.25);
  EXPECT_EQ(wrap(-0.25, 2.0), 1.75);
  EXPECT_EQ(wrap(2.25, 2.0), 0.25);
  EXPECT_EQ(wrap(2.0, 2.0), 0.0);
  EXPECT_EQ(wrap(-1e-30, 2.0), 0.0);  // rounds up to the period itself, which is outside
  EXPECT_EQ(wrap(0.0, 2.0), 0.0);
}

TEST(Shortest, IsAntisymmetricAndShort) {
  std::mt19937_64 random(1);
  const double period = 0.7;
  for (int i = 0; i < 10000; ++i) {
    const double d = (static_cast<double>(random() >> 11U) * 0x1p-53 * 2.0 - 1.0) * period;
    ASSERT_EQ(shortest(-d, period), -shortest(d, period));
    ASSERT_LE(std::fabs(shortest(d, period)), 0.5 * period);
    ASSERT_NEAR(std::remainder(shortest(d, period) - d, period), 0.0, 1e-15);
  }
  EXPECT_EQ(shortest(0.5 * period, period), 0.5 * period);
  EXPECT_EQ(shortest(-0.5 * period, period), -0.5 * period);
}

TEST(Container, Axes) {
  EXPECT_EQ(box3(2.0, 3.0, false, false).mean_area(), 6.0);
  EXPECT_EQ(box3(2.0, 3.0, false, false).height(), 1.0);
  EXPECT_EQ(box3(2.0, 3.0, false, false).lateral_axes(), 2);
  EXPECT_EQ(box2(2.0, false).mean_area(), 2.0);
  EXPECT_EQ(box2(2.0, false).vertical(), 1);
}

TEST(ColumnGrid, ColumnsAreAsManyAsFitTheReach) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 20000; ++i) {
    const double reach = 0.001 * static_cast<double>(1 + random() % 100);
    const double length = reach * static_cast<double>(random() % 60) + (random() % 2 == 0 ? 0.0 : 0.0007);
    if (length == 0.0) continue;
    const ColumnGrid grid(box2(length, false), reach);
    const int n = grid.counts()[0];
    ASSERT_GE(n, 1);
    ASSERT_TRUE(n == 1 || length / n >= reach) << length << " " << reach;
    ASSERT_LT(length / (n + 1), reach * (1.0 + 1e-15));
    ASSERT_EQ(grid.counts()[1], 1);
    ASSERT_EQ(grid.size(), n);
  }
  EXPECT_EQ(ColumnGrid(box3(1.0, 0.5, false, false), 0.1).counts(), (std::array<int, 2>{10, 5}));
}

TEST(ColumnGrid, AreWiderWhereTheyWouldBeTooMany) {
  for (const Container& box : boxes()) {  // few enough: nothing changes
    const ColumnGrid few(box, 1.0, 100);
    EXPECT_EQ(few.counts(), ColumnGrid(box, 1.0).counts());
    EXPECT_EQ(few.widths(), ColumnGrid(box, 1.0).widths());
  }
  for (const double lx : {1e3, 1e6, 1e12, 1e200}) {
    for (const double ly : {0.5, 3.1, 7.0, 1e3, 1e6, 1e150}) {
      for (const bool periodic : {false, true}) {
        if (periodic && ly < 3.0) continue;  // refused by the scene
        for (const std::int64_t most : {std::int64_t{9}, std::int64_t{1000}, std::int64_t{1} << 30}) {
          const ColumnGrid grid(box3(lx, ly, periodic, periodic), 1.0, most);
          ASSERT_LE(grid.size(), most) << lx << " " << ly << " " << periodic;
          for (const std::size_t axis : {0u, 1u}) {
            ASSERT_TRUE(grid.counts()[axis] == 1 || grid.widths()[axis] >= 1.0);
            ASSERT_GE(grid.counts()[axis], periodic ? 3 : 1);
          }
          const bool square = lx == ly && lx * ly > static_cast<double>(most);
          ASSERT_TRUE(!square || grid.size() > most / 4);  // no wider than they must be
        }
      }
    }
    const ColumnGrid flat(box2(lx, false), 1.0, 100);
    EXPECT_LE(flat.size(), 100);
    EXPECT_GE(flat.size(), 98);
  }
}

TEST(ColumnGrid, EveryPositionHasAColumn) {
  const ColumnGrid grid(box3(5.5, 3.2, false, true), 1.0);
  EXPECT_EQ(grid.counts(), (std::array<int, 2>{5, 3}));
  EXPECT_EQ(grid.coordinate(0, 0.0), 0);
  EXPECT_EQ(grid.coordinate(0, 1.2), 1);
  EXPECT_EQ(grid.coordinate(0, std::nextafter(5.5, 0.0)), 4);
  EXPECT_EQ(grid.coordinate(0, 5.5), 4);
  EXPECT_EQ(grid.coordinate(0, -0.3), 0);
  EXPECT_EQ(grid.coordinate(0, -7e300), 0);
  EXPECT_EQ(grid.coordinate(0, 7e300), 4);
  EXPECT_EQ(grid.coordinate(0, std::numeric_limits<double>::infinity()), 4);
  EXPECT_EQ(grid.coordinate(0, std::numeric_limits<double>::quiet_NaN()), 0);
  EXPECT_EQ(grid.column({1.2, 3.1, 99.0}), grid.index(1, 2));
  EXPECT_EQ(grid.index(1, 2), 11);
  const ColumnGrid flat(box2(5.5, false), 1.0);
  EXPECT_EQ(flat.column({1.2, 99.0, 0.0}), 1);  // y is the vertical
}

/// How many columns apart along one axis, the short way round.
int steps(int a, int b, int n, bool periodic) {
  const int d = std::abs(a - b);
  return periodic ? std::min(d, n - d) : d;
}

TEST(ColumnGrid, NeighborsAreThoseThatTouchEachOnce) {
  for (const Container& box : boxes()) {
    const ColumnGrid grid(box, 1.0);
    const auto [nx, ny] = grid.counts();
    std::vector<ColumnIndex> got{99};
    for (ColumnIndex c = 0; c < grid.size(); ++c) {
      std::vector<ColumnIndex> expected;
      for (ColumnIndex other = 0; other < grid.size(); ++other) {
        const int dx = steps(static_cast<int>(c % nx), static_cast<int>(other % nx), nx, box.periodic[0]);
        const int dy = steps(static_cast<int>(c / nx), static_cast<int>(other / nx), ny, box.periodic[1]);
        if (other != c && dx <= 1 && dy <= 1) expected.push_back(other);
      }
      grid.neighbors(c, got);
      EXPECT_EQ(got, expected) << c << " of " << nx << " x " << ny;
    }
  }
}

TEST(ColumnGrid, ThreePeriodicColumnsAreAllNeighbors) {
  const ColumnGrid grid(box3(3.0, 3.0, true, true), 1.0);
  std::vector<ColumnIndex> got;
  grid.neighbors(4, got);
  EXPECT_EQ(got, (std::vector<ColumnIndex>{0, 1, 2, 3, 5, 6, 7, 8}));
  const ColumnGrid flat(box2(3.0, true), 1.0);
  flat.neighbors(0, got);
  EXPECT_EQ(got, (std::vector<ColumnIndex>{1, 2}));
}

/// The shortest way to a point of a fine raster of the column.
double sampled_distance(const ColumnGrid& grid, const Vec3& p, ColumnIndex column) {
  const Container& box = grid.box();
  const auto [nx, ny] = grid.counts();
  const auto [wx, wy] = grid.widths();
  constexpr int raster = 64;
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= raster; ++i) {
    for (int j = 0; j <= (box.dimension == 3 ? raster : 0); ++j) {
      const double x = (static_cast<double>(column % nx) + i / double{raster}) * wx;
      const double y = (static_cast<double>(column / nx) + j / double{raster}) * wy;
      const double dx = box.periodic[0] ? shortest(p[0] - x, box.size[0]) : p[0] - x;
      const double dy = box.dimension == 2 ? 0.0 : box.periodic[1] ? shortest(p[1] - y, box.size[1]) : p[1] - y;
      best = std::min(best, std::hypot(dx, dy));
    }
  }
  return best;
}

TEST(ColumnGrid, DistanceAgreesWithSampledPoints) {
  std::mt19937_64 random(3);
  const auto unit = [&] { return static_cast<double>(random() >> 11U) * 0x1p-53; };
  for (const Container& box : boxes()) {
    const ColumnGrid grid(box, 1.0);
    for (int i = 0; i < 20; ++i) {
      const Vec3 p{unit() * box.size[0], box.dimension == 3 ? unit() * box.size[1] : unit(), unit()};
      for (ColumnIndex c = 0; c < grid.size(); ++c) {
        const double got = grid.distance(p, c);
        const double sampled = sampled_distance(grid, p, c);
        EXPECT_LE(got, sampled + 1e-12);
        EXPECT_GE(got, sampled - 0.03);  // a raster step is up to 2/64, and distance() may end between two points
        if (grid.column(p) == c) {
          EXPECT_EQ(got, 0.0);
        } else {
          EXPECT_GT(got, 0.0);
        }
      }
    }
  }
}

TEST(ColumnGrid, DistanceIsExactInSimpleCases) {
  const ColumnGrid walls(box3(4.0, 4.0, false, false), 1.0);
  EXPECT_EQ(walls.distance({0.5, 0.5, 9.0}, walls.index(3, 0)), 2.5);
  EXPECT_EQ(walls.distance({0.25, 0.0, 0.0}, walls.index(2, 0)), 1.75);
  EXPECT_EQ(walls.distance({1.0 - 0.375, 1.0 - 0.5, 0.0}, walls.index(1, 1)), 0.625);  // 3-4-5
  const ColumnGrid round(box3(4.0, 4.0, true, true), 1.0);
  EXPECT_EQ(round.distance({0.5, 0.5, 9.0}, round.index(3, 0)), 0.5);
  EXPECT_EQ(round.distance({0.375, 0.5, 0.0}, round.index(3, 3)), 0.625);
}

TEST(ColumnGrid, PressedIntoAWallIsStillInTheBorderColumn) {
  const ColumnGrid grid(box3(4.0, 4.0, false, false), 1.0);
  EXPECT_EQ(grid.distance({-0.125, 0.5, 0.0}, grid.index(0, 0)), 0.0);
  EXPECT_EQ(grid.distance({4.125, 4.25, 0.0}, grid.index(3, 3)), 0.0);
  // Another one pressed into the same wall may be this near: the column has no outer edge.
  EXPECT_EQ(grid.distance({-0.125, 0.5, 0.0}, grid.index(0, 1)), 0.5);
}

}  // namespace
}  // namespace packmpi::geometry
