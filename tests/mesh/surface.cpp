// Surfaces of triangles: what is read, mended and refused; volumes, sections and distances against slow ways.
#include "mesh/surface.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>

#include "base/error.hpp"
#include "geometry/cut_volume.hpp"
#include "mesh/bodies.hpp"
#include "mesh/shapes.hpp"

namespace packmpi::mesh {
namespace {

using testing::Dice;
using testing::Soup;

constexpr double pi = std::numbers::pi;

std::string text_stl(const Soup& soup) {
  std::string text = "solid a name with facet in it\r\n";
  for (const Corners& c : soup) {
    text += " facet normal nan 0 0\n  outer loop\n";
    for (const Vec3& x : c) text += fmt::format("   vertex {} {} {:e}\n", x[0], x[1], x[2]);
    text += "  ENDLOOP\n endfacet\n";
  }
  return text + "endsolid a name\n";
}

std::string obj(const Soup& soup) {
  std::string text = "# no comment\nmtllib a.mtl\no part\n";
  for (const Corners& c : soup) {
    for (const Vec3& x : c) text += fmt::format("v {} {} +{}\n", x[0], x[1], x[2]);
    text += "vn 0 0 1\nf -3/1 -2//1 -1\n";
  }
  return text;
}

std::string refused(const std::string& bytes, const std::string& path) {
  try {
    (void)read_triangles(bytes, path);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    return error.what();
  }
  return "";
}

std::string refused(const Soup& soup) {
  try {
    (void)Surface(soup, "a.stl");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    return error.what();
  }
  return "";
}

bool holds(const std::string& words, const std::string& part) { return words.find(part) != std::string::npos; }

TEST(Read, TheSameFromAllFormats) {
  const Soup soup = testing::box({0.0, 0.1, 0.2}, {1.3, 2.0, 123.456});
  EXPECT_EQ(read_triangles(text_stl(soup), "a.stl"), soup);
  EXPECT_EQ(read_triangles(obj(soup), "b.OBJ"), soup);
  std::string binary = binary_stl(soup);
  EXPECT_EQ(read_triangles(binary, "a.STL"), soup);  // 0.1 is 0.1, though in single precision
  std::memcpy(binary.data(), "solid of a program that lies", 28);
  EXPECT_EQ(read_triangles(binary, "a.stl"), soup);
  EXPECT_EQ(read_triangles("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", "a.obj"),
            (Soup{{Vec3{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {Vec3{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}}));
}

TEST(Read, SaysWhatIsWrong) {
  const Soup soup = testing::box({0, 0, 0}, {1, 1, 1});
  const std::string text = text_stl(soup), binary = binary_stl(soup);
  EXPECT_TRUE(holds(refused(text, "a.ply"), "a.ply: a surface is read from files that end in .stl or .obj"));
  EXPECT_TRUE(
      holds(refused(binary.substr(0, 400), "a.stl"), "says 12 triangles and so has to have 684 bytes, not 400"));
  EXPECT_TRUE(holds(refused("", "a.stl"), "it is no STL file"));
  EXPECT_TRUE(holds(refused("solid\nendsolid", "a.stl"), "it has no triangle"));
  EXPECT_TRUE(
      holds(refused("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1,5", "a.stl"), "line 4: \"1,5\" is no number"));
  EXPECT_TRUE(holds(refused(text.substr(0, 300), "a.stl"), "line"));
  EXPECT_TRUE(holds(refused("solid\nfacet normal 0 0 1\nvertex", "a.stl"), "line 3: \"vertex\" where outer belongs"));
  EXPECT_TRUE(holds(refused("v 0 0 0\nv 1 0 0\nf 1 2 3\n", "a.obj"), "line 3: \"3\" is none of the 2 vertices"));
  EXPECT_TRUE(holds(refused("v 0 0\nv 1 0 0\n", "a.obj"), "line 1: \"the end\" is no number"));
  EXPECT_TRUE(holds(refused("v 0 0 inf\n", "a.obj"), "is no number"));
  EXPECT_TRUE(holds(refused("v 0 0 0\ncurv 1\n", "a.obj"), "line 2: \"curv\" is nothing that is read"));
  std::string many(84, '\0');
  many[83] = 0x7f;
  EXPECT_TRUE(holds(refused(many, "a.stl"), "has to have"));
  std::string broken = binary;
  std::memset(broken.data() + 84 + 12, 0xff, 4);
  EXPECT_TRUE(holds(refused(broken, "a.stl"), "triangle 1 has a corner that is no number"));
}

TEST(Close, MendsAndSays) {
  Soup soup = testing::box({0, 0, 0}, {1, 2, 3}, 3);
  Dice dice(1);
  for (Corners& c : soup) {  // corners that differ by rounding; every triangle looks anywhere
    for (Vec3& x : c) {
      for (double& one : x) one += dice(-1e-7, 1e-7);
    }
  }
  for (std::size_t t : {0U, 7U, 40U}) std::swap(soup[t][1], soup[t][2]);
  soup.push_back({soup[0][0], soup[0][0], soup[1][1]});
  const Surface mended(soup, "a");
  EXPECT_EQ(mended.shell().mended.turned, 3);
  EXPECT_EQ(mended.shell().mended.dropped, 1);
  EXPECT_EQ(mended.shell().points.size(), 56U);
  EXPECT_NEAR(mended.volume(), 6.0, 1e-5);

  Soup inside_out = testing::ball(2);
  for (Corners& c : inside_out) std::swap(c[1], c[2]);
  const Surface turned(inside_out, "a"), ball(testing::ball(2), "a");
  EXPECT_EQ(turned.shell().mended.turned, 128);
  EXPECT_EQ(turned.volume(), ball.volume());
  EXPECT_EQ(turned.shell().mended.parts, 1);
}

/// A surface inside another is an obstacle, one inside that an interior again, whichever way they look.
TEST(Close, ASurfaceInsideIsAHole) {
  Soup soup = testing::box({0, 0, 0}, {4, 4, 4});
  const auto add = [&](const Soup& more) { soup.insert(soup.end(), more.begin(), more.end()); };
  add(testing::box({1, 1, 1}, {3, 3, 3}));
  add(testing::box({1.5, 1.5, 1.5}, {2, 2, 2}));
  add(testing::box({5, 0, 0}, {6, 1, 1}));
  const Surface surface(soup, "a");
  EXPECT_EQ(surface.shell().mended.parts, 4);
  EXPECT_EQ(surface.shell().mended.turned, 12);
  EXPECT_NEAR(surface.volume(), 64.0 - 8.0 + 0.125 + 1.0, 1e-12);
  EXPECT_NEAR(surface.area_at(2.5), 16.0 - 4.0, 1e-13);
  EXPECT_LT(surface.nearest({1.2, 2.0, 2.0}).distance, 0.0);
  EXPECT_GT(surface.nearest({1.7, 1.7, 1.7}).distance, 0.0);
}

TEST(Close, SaysWhatItCannotMend) {
  const Soup box = testing::box({0, 0, 0}, {1, 1, 1}, 2);
  Soup open(box.begin() + 1, box.end());
  EXPECT_TRUE(
      holds(refused(open), "a.stl: the surface is open: 3 edges belong to one triangle only, the first from ("));
  Soup twice = box;
  twice.push_back(box[5]);
  EXPECT_TRUE(holds(refused(twice), "3 edges belong to more than two triangles"));
  Soup two = box;
  for (const Corners& c : testing::moved(box, [](const Vec3& x) { return plus(x, {0.3, 0.4, 0.55}); }))
    two.push_back(c);
  EXPECT_TRUE(holds(refused(two), "the surface cuts itself"));
  two = box;  // walls in one plane, over each other
  for (const Corners& c : testing::box({1, 0.25, 0.25}, {2, 0.75, 0.75})) two.push_back(c);
  EXPECT_TRUE(holds(refused(two), "the surface cuts itself"));
  const Soup pushed = testing::moved(box, [](const Vec3& x) {
    return x[0] == 0.5 && x[1] == 0.5 && x[2] == 1.0 ? Vec3{0.5, 0.5, -0.2} : x;
  });
  EXPECT_TRUE(holds(refused(pushed), "the surface cuts itself"));
  EXPECT_TRUE(holds(refused({{Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}), "1 x 1 x 0 m large and encloses no volume"));
  const std::array<Vec3, 6> p{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0.2}, {0.3, 1, 1}}};
  Soup hemi;  // of the icosahedron: the projective plane
  for (const std::array<int, 3>& t : {std::array{1, 2, 3},
                                      {1, 3, 4},
                                      {1, 4, 5},
                                      {1, 5, 6},
                                      {1, 6, 2},
                                      {2, 3, 5},
                                      {3, 4, 6},
                                      {4, 5, 2},
                                      {5, 6, 3},
                                      {6, 2, 4}}) {
    hemi.push_back({p.at(std::size_t(t[0] - 1)), p.at(std::size_t(t[1] - 1)), p.at(std::size_t(t[2] - 1))});
  }
  EXPECT_TRUE(holds(refused(hemi), "one side only"));
  EXPECT_EQ(refused(testing::ball(4)), "");
  EXPECT_EQ(refused(testing::l_prism(1.0, 5)), "");
}

Soup leaning_hopper() {
  return testing::moved(testing::hopper(0.3, 2), [](const Vec3& x) { return testing::turned(x, 0.7, 0.3); });
}

TEST(Volume, OfKnownShapes) {
  for (int n : {1, 4}) {
    const Surface box(testing::box({0.1, 0.2, 0.3}, {1.1, 2.2, 3.3}, n), "a");
    EXPECT_NEAR(box.volume(), 6.0, 1e-14);
    EXPECT_NEAR(box.volume_below(1.0), 1.4, 1e-14);
    EXPECT_NEAR(box.area_at(1.0), 2.0, 1e-14);
    EXPECT_EQ(box.volume_below(0.3), 0.0);
    EXPECT_EQ(box.area_at(0.2), 0.0);
    const Surface hopper(testing::hopper(0.5, n), "a");
    const double side = 0.5 + 1.5 * 0.4;  // at z = 0.4
    EXPECT_NEAR(hopper.volume_below(0.4), 0.4 / 3.0 * (0.25 + 0.5 * side + side * side), 1e-14);
    EXPECT_NEAR(hopper.area_at(0.4), side * side, 1e-14);
    EXPECT_NEAR(hopper.volume(), (0.25 + 1.0 + 4.0) / 3.0 + 4.0, 1e-13);
    EXPECT_NEAR(Surface(testing::l_prism(2.0, n), "a").area_at(1.5), 3.0, 1e-14);
  }
}

/// Sections of a convex body: its edges' crossings in order around their middle.
double slow_section(const Soup& soup, double z) {
  std::vector<std::array<double, 2>> points;
  for (const Corners& c : soup) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &a = c.at(k), &b = c.at((k + 1) % 3);
      if ((a[2] < z) == (b[2] < z)) continue;
      const double u = (z - a[2]) / (b[2] - a[2]);
      points.push_back({a[0] + u * (b[0] - a[0]), a[1] + u * (b[1] - a[1])});
    }
  }
  std::array<double, 2> middle{};
  for (const auto& p : points) middle[0] += p[0] / double(points.size()), middle[1] += p[1] / double(points.size());
  std::ranges::sort(points, {}, [&](const auto& p) { return std::atan2(p[1] - middle[1], p[0] - middle[0]); });
  double area = 0.0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const auto &p = points[k], &q = points[(k + 1) % points.size()];
    area += 0.5 * ((p[0] - middle[0]) * (q[1] - middle[1]) - (p[1] - middle[1]) * (q[0] - middle[0]));
  }
  return area;
}

TEST(Volume, IsTheIntegralOfSections) {
  for (const Soup& soup : {testing::ball(3), leaning_hopper()}) {
    const Surface surface(soup, "a");
    std::vector<double> heights;
    for (const Vec3& x : surface.shell().points) heights.push_back(x[2]);
    std::ranges::sort(heights);
    double sum = 0.0;
    for (std::size_t k = 0; k + 1 < heights.size(); ++k) {  // quadratic between them: Simpson's rule is exact
      const double low = heights[k], high = heights[k + 1], middle = 0.5 * (low + high);
      if (high - low < 1e-9) continue;
      const double a = slow_section(soup, low + 1e-12), b = slow_section(soup, middle),
                   c = slow_section(soup, high - 1e-12);
      EXPECT_NEAR(surface.area_at(middle), b, 1e-12);
      sum += (high - low) / 6.0 * (a + 4.0 * b + c);
      EXPECT_NEAR(surface.volume_below(high), sum, 1e-9);
    }
    EXPECT_NEAR(surface.volume(), sum, 1e-9);
  }
}

/// By the plane if the foot is inside, else by the three segments.
double slow_distance(const Corners& c, const Vec3& x) {
  const Vec3 n = unit(cross(minus(c[1], c[0]), minus(c[2], c[0])));
  bool inside = true;
  double best = HUGE_VAL;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &a = c.at(k), &b = c.at((k + 1) % 3);
    const Vec3 along = minus(b, a);
    inside = inside && dot(cross(along, minus(x, a)), n) >= 0.0;
    const double u = std::clamp(dot(minus(x, a), along) / dot(along, along), 0.0, 1.0);
    best = std::min(best, norm(minus(x, plus(a, times(u, along)))));
  }
  return inside ? std::min(best, std::abs(dot(n, minus(x, c[0])))) : best;
}

/// By the triangles that a ray passes through.
bool slow_inside(const Soup& soup, const Vec3& x, const Vec3& ray) {
  int passed = 0;
  for (const Corners& c : soup) {
    const Vec3 a = minus(c[0], x), b = minus(c[1], x), d = minus(c[2], x);
    const double u = dot(ray, cross(a, b)), v = dot(ray, cross(b, d)), w = dot(ray, cross(d, a));
    const bool hit = (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
    if (hit && dot(a, cross(minus(b, a), minus(d, a))) / dot(ray, cross(minus(b, a), minus(d, a))) > 0.0) ++passed;
  }
  return passed % 2 == 1;
}

TEST(Distance, EqualsThatOfAllTriangles) {
  Dice dice(3);
  Soup with_hole = testing::ball(2);
  for (const Corners& c : testing::box({-0.3, -0.2, -0.4}, {0.3, 0.3, 0.1})) with_hole.push_back(c);
  for (const Soup& soup :
       {testing::box({0, 0, 0}, {1, 1, 1}), testing::l_prism(1.0, 2), leaning_hopper(), testing::ball(3), with_hole}) {
    const Surface surface(soup, "a");
    for (int k = 0; k < 400; ++k) {
      Vec3 x = dice.point(-2.5, 2.5);
      if (k % 4 == 0) x = surface.shell().points[std::size_t(dice(0.0, 1.0) * double(surface.shell().points.size()))];
      if (k % 4 == 0) x = plus(x, dice.point(-0.01, 0.01));
      double expected = HUGE_VAL;
      for (const Corners& c : soup) expected = std::min(expected, slow_distance(c, x));
      if (!slow_inside(soup, x, {0.36, 0.48, 0.81})) expected = -expected;
      EXPECT_NEAR(surface.nearest(x).distance, expected, 1e-12);
      EXPECT_NEAR(std::abs(expected), norm(minus(x, surface.nearest(x).place)), 1e-12);
      const double range = dice(0.0, 1.0);
      EXPECT_NEAR(surface.distance(x, range), std::clamp(expected, -range, range), 1e-12);
      EXPECT_EQ(surface.fits(x, range), surface.distance(x, range) >= range);
      EXPECT_EQ(surface.beyond(x) > 0.0, expected < 0.0);
      EXPECT_LE(-surface.beyond(x), expected + 1e-12);
    }
  }
}

TEST(VolumeOfSphere, InBoxesAnyWayTheyLie) {
  Dice dice(5);
  double largest = 0.0;
  for (int k = 0; k < 150; ++k) {
    const Vec3 size{dice(0.2, 3.0), dice(0.2, 3.0), dice(0.2, 3.0)};
    const double a = k % 2 == 0 ? 0.0 : dice(0.0, 6.0), b = k % 2 == 0 ? 0.0 : dice(0.0, 6.0);
    const Surface surface(testing::moved(testing::box({0, 0, 0}, size, 1 + k % 3),
                                         [&](const Vec3& x) { return testing::turned(x, a, b); }),
                          "a");
    const double r = dice(0.1, 1.5);
    Vec3 x{};
    for (std::size_t i = 0; i < 3; ++i) x[i] = dice(-r, size[i] + r);
    if (k % 10 == 0) x = {0.5 * size[0], k % 20 == 0 ? 0.0 : 0.5 * size[1], 0.0};  // on the surface
    const double expected = geometry::volume_in_box(r, minus({0, 0, 0}, x), minus(size, x));
    const double error = std::abs(surface.volume_of_sphere(testing::turned(x, a, b), r) - expected) / (r * r * r);
    EXPECT_LT(error, 1e-9) << k;
    largest = std::max(largest, error);
  }
  RecordProperty("largest_error", fmt::format("{}", largest));
}

/// Rooms that share space out share a sphere out: the tetrahedra of a cube, and an L with what completes it.
TEST(VolumeOfSphere, AddsUp) {
  Dice dice(7);
  std::vector<Surface> parts;
  std::array<std::size_t, 3> order{0, 1, 2};
  do {
    std::array<Vec3, 4> p{};
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t j = k; j < 3; ++j) p.at(j + 1)[order[k]] = 1.0;
    }
    parts.emplace_back(Soup{{p[0], p[1], p[2]}, {p[0], p[2], p[3]}, {p[0], p[3], p[1]}, {p[1], p[3], p[2]}}, "a");
  } while (std::next_permutation(order.begin(), order.end()));
  const Surface l(testing::l_prism(1.5, 2), "a"), rest(testing::box({1, 1, 0}, {2, 2, 1.5}), "a");
  for (int k = 0; k < 200; ++k) {
    const double r = dice(0.1, 1.2);
    const Vec3 x = k % 20 == 0 ? Vec3{1.0, 1.0, 0.5} : dice.point(-0.5, 2.0);
    double sum = 0.0;
    for (const Surface& part : parts) sum += part.volume_of_sphere(x, r);
    EXPECT_NEAR(sum, geometry::volume_in_box(r, minus({0, 0, 0}, x), minus({1, 1, 1}, x)), 1e-9 * r * r * r) << k;
    EXPECT_NEAR(l.volume_of_sphere(x, r) + rest.volume_of_sphere(x, r),
                geometry::volume_in_box(r, minus({0, 0, 0}, x), minus({2, 2, 1.5}, x)), 1e-9 * r * r * r)
        << k;
  }
  const Surface ball(testing::ball(3), "a");
  EXPECT_NEAR(ball.volume_of_sphere({0.2, 0.1, 0.0}, 2.0), ball.volume(), 1e-12);
  EXPECT_EQ(ball.volume_of_sphere({0.2, 0.1, 0.0}, 0.5), 4.0 / 3.0 * pi * 0.125);
  EXPECT_EQ(ball.volume_of_sphere({3.2, 0.1, 0.0}, 0.5), 0.0);
}

/// Bodies of facets are as large as the round ones, closed, and look outside.
TEST(Bodies, AreAsLargeAsTheRoundOnes) {
  const auto expect = [](const Soup& soup, double volume, const Vec3& low, const Vec3& high) {
    const Surface surface(soup, "body");
    EXPECT_NEAR(surface.volume(), volume, 1e-13 * volume);
    EXPECT_EQ(surface.shell().mended.turned, 0);
    EXPECT_EQ(surface.shell().mended.dropped, 0);
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_NEAR(surface.low()[a], low[a], 2e-3);
      EXPECT_NEAR(surface.high()[a], high[a], 2e-3);
    }
  };
  expect(prism_over({{0, 0}, {2, 0}, {0, 1}}, 3.0), 3.0, {0, 0, 0}, {2, 1, 3});
  expect(body_of_revolution({{0, 0}, {0.5, 0}, {0.5, 2}, {0, 2}}), 0.5 * pi, {-0.5, -0.5, 0}, {0.5, 0.5, 2});
  expect(body_of_revolution({{0, 0}, {0.5, 0}, {1, 2}, {0, 2}}), 2.0 / 3.0 * pi * (0.25 + 0.5 + 1.0), {-1, -1, 0},
         {1, 1, 2});
  expect(body_of_revolution({{0.5, 0}, {1, 0}, {1, 2}, {0.5, 2}}), 1.5 * pi, {-1, -1, 0}, {1, 1, 2});
  expect(sphere_of_facets(0.7), 4.0 / 3.0 * pi * 0.343, {-0.7, -0.7, -0.7}, {0.7, 0.7, 0.7});
}

/// Corners and middles of the facets of a cylinder and a sphere lie within the shares of a radius that doc/vessels.md
/// has.
TEST(Bodies, AreNearTheRoundOnes) {
  const auto farthest = [](const Soup& soup, const auto& from_wall) {
    double most = 0.0;
    for (const Corners& c : soup) {
      for (const Vec3& x :
           {c[0], c[1], c[2], times(0.5, plus(c[0], c[1])), times(0.5, plus(c[1], c[2])), times(0.5, plus(c[2], c[0]))})
        most = std::max(most, std::abs(from_wall(x)));
    }
    return most;
  };
  EXPECT_LT(farthest(sphere_of_facets(1.0), [](const Vec3& x) { return norm(x) - 1.0; }), 2e-3);
  // The side alone: of a cap's strips the middles lie inside.
  Soup side = body_of_revolution({{0, 0}, {1, 0}, {1, 2}, {0, 2}});
  std::erase_if(side, [](const Corners& c) { return c[0][2] == c[1][2] && c[1][2] == c[2][2]; });
  EXPECT_LT(farthest(side, [](const Vec3& x) { return std::hypot(x[0], x[1]) - 1.0; }), 2e-4);
}

}  // namespace
}  // namespace packmpi::mesh
