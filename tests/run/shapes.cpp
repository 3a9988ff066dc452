// Frusta, spheres and annuli, in 2D circles, trapezia and polygons: what a particle feels of their walls, and packs in
// them: one on any number of ranks and after a stop, none of it outside, as dense as it should be.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>

#include "geometry/volume.hpp"
#include "input/read.hpp"
#include "observe/measure.hpp"
#include "support/packs_on_ranks.hpp"
#include "support/placed_bed.hpp"
#include "support/wall_force.hpp"

namespace packmpi::run {
namespace {

using input::VesselShape;
using test::Bench;

constexpr double r = 0.05;

input::Input in_vessel(input::Input in, VesselShape shape, double first, double second, double height) {
  input::Container& c = in.container;
  c.shape = shape;
  c.height = height;
  if (shape == VesselShape::frustum) c.bottom_diameter = first, c.top_diameter = second;
  if (shape != VesselShape::frustum) c.diameter = first, c.inner_diameter = second;
  const double widest = std::max(first, second);
  c.size = {widest, widest, height};
  if (c.dimension == 2) c.size = {widest, height};
  return in;
}

input::Input in_trapezium(const input::Input& in, double bottom, double top, double height) {
  input::Input made = in_vessel(in, VesselShape::trapezium, std::max(bottom, top), 0.0, height);
  made.container.sides = std::make_shared<const geometry::Polygon>(bottom, top, height);
  return made;
}

void expect_force(const input::Input& in, const Vec3& on_wall, const Vec3& inward, double depth) {
  test::expect_force(in, r, on_wall, inward, depth);
}

// One sphere wants one rank.
class SlopingWalls : public ::testing::Test {
 protected:
  void SetUp() override {
    if (comm::Comm(MPI_COMM_WORLD).size() > 1) GTEST_SKIP() << "on one rank";
  }
};

TEST_F(SlopingWalls, PushAsHertzSays) {
  const input::Input empty = test::vacuum(3, 1.0, r, 1e-6, 2.0);
  const double depth = 1e-3, rise = 0.5, c = 1.0 / std::sqrt(1.0 + rise * rise);
  // A cone of radius 0.2 + z / 2: at z = 0.6 it is 0.5, and points inward and up.
  const input::Input hopper = in_vessel(empty, VesselShape::frustum, 0.4, 1.4, 1.0);
  expect_force(hopper, {0.7 + 0.5 * 0.6, 0.7 + 0.5 * 0.8, 0.6}, {-0.6 * c, -0.8 * c, rise * c}, depth);
  // The same upside down: inward and down.
  const input::Input heap = in_vessel(empty, VesselShape::frustum, 1.4, 0.4, 1.0);
  expect_force(heap, {0.7 - 0.4, 0.7, 0.6}, {c, 0.0, -rise * c}, depth);
  const input::Input ball = in_vessel(empty, VesselShape::sphere, 1.0, 0.0, 0.9);
  expect_force(ball, {0.5 + 0.5 * 0.48, 0.5 + 0.5 * 0.64, 0.5 - 0.5 * 0.6}, {-0.48, -0.64, 0.6}, depth);
  expect_force(ball, {0.5, 0.5, 0.0}, {0.0, 0.0, 1.0}, depth);  // at its lowest point, with no floor beside it
  const input::Input ring = in_vessel(empty, VesselShape::annulus, 1.0, 0.4, 1.0);
  expect_force(ring, {0.5 - 0.2 * 0.6, 0.5 + 0.2 * 0.8, 0.5}, {-0.6, 0.8, 0.0}, depth);
  expect_force(ring, {0.5 - 0.5 * 0.6, 0.5 + 0.5 * 0.8, 0.5}, {0.6, -0.8, 0.0}, depth);
  const input::Input circle = in_vessel(test::vacuum(2, 1.0, r, 1e-6, 2.0), VesselShape::circle, 1.0, 0.0, 0.9);
  expect_force(circle, {0.5 + 0.5 * 0.6, 0.5 - 0.5 * 0.8, 0.0}, {-0.6, 0.8, 0.0}, depth);
  expect_force(circle, {0.5, 0.0, 0.0}, {0.0, 1.0, 0.0}, depth);
  const input::Input flat = in_trapezium(test::vacuum(2, 1.0, r, 1e-6, 2.0), 0.4, 1.4, 1.0);
  expect_force(flat, {0.7 + 0.5, 0.6, 0.0}, {-c, rise * c, 0.0}, depth);  // half as wide as 0.2 + z / 2
  expect_force(flat, {0.7 - 0.5, 0.6, 0.0}, {c, rise * c, 0.0}, depth);
  expect_force(flat, {0.7, 0.0, 0.0}, {0.0, 1.0, 0.0}, depth);
  expect_force(flat, {0.0, 1.3, 0.0}, {1.0, 0.0, 0.0}, depth);  // above H_d
}

input::Input sloping(int dimension, double g, double friction, bool memory) {
  input::Input in = test::vacuum(dimension, 1.0, r, 1e-5, 2.0);
  in.jamming.gravity = g;
  in.contact.damping_ratio = 0.5;
  in.contact.friction = in.contact.wall_friction = friction;
  if (memory) in.contact.tangential = input::Tangential::mindlin;
  return in;
}

// On a cone's wall a sphere slides with g sin(slope), and rolls with 5/7 of it, whether friction remembers or not.
TEST_F(SlopingWalls, LetASphereSlideAndRollDown) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const double rise = 1.0, g = 2.0, seconds = 0.6, slope = std::sqrt(0.5);
  for (const double friction : {0.0, 0.6}) {
    for (const bool memory : {false, true}) {
      if (memory && friction == 0.0) continue;
      Bench bench(comm, in_vessel(sloping(3, g, friction, memory), VesselShape::frustum, 0.4, 2.4, 1.0));
      const double z = 0.8, depth = std::pow(test::mass(r) * g * slope / test::hertz(r, 1.0), 2.0 / 3.0);
      const double rho = 0.2 + rise * z - (r - depth) / slope;  // its weight is on the wall from the beginning
      bench.place({1.2 + rho * 0.6, 1.2 + rho * 0.8, z}, r);
      bench.start();
      bench.step(std::llround(seconds / bench.dt()));
      const Bench::State at = bench.state(0);
      const double speed = norm(at.v), expected = (friction > 0.0 ? 5.0 / 7.0 : 1.0) * g * slope * seconds;
      EXPECT_NEAR(speed, expected, 0.01 * expected) << friction << memory;
      EXPECT_NEAR(at.v[2], -slope * speed, 1e-3 * speed);
      EXPECT_NEAR(at.v[0] * 0.8, at.v[1] * 0.6, 1e-6);  // straight down
      EXPECT_NEAR(norm(at.omega) * r, friction > 0.0 ? speed : 0.0, 0.01 * speed);
    }
  }
}

// So does a disc on a side of a trapezium: spheres whose centres stay in a plane.
TEST_F(SlopingWalls, LetADiscSlideAndRollDown) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const double g = 2.0, seconds = 0.6, slope = std::sqrt(0.5);
  for (const auto& [friction, memory] : {std::pair(0.0, false), {0.6, false}, {0.6, true}}) {
    Bench bench(comm, in_trapezium(sloping(2, g, friction, memory), 0.4, 2.4, 1.0));
    const double y = 0.8, depth = std::pow(test::mass(r) * g * slope / test::hertz(r, 1.0), 2.0 / 3.0);
    bench.place({1.2 + 0.2 + y - (r - depth) / slope, y, 0.0}, r);  // its weight is on the wall from the beginning
    bench.start();
    bench.step(std::llround(seconds / bench.dt()));
    const Bench::State at = bench.state(0);
    const double speed = norm(at.v), expected = (friction > 0.0 ? 5.0 / 7.0 : 1.0) * g * slope * seconds;
    EXPECT_NEAR(speed, expected, 0.01 * expected) << friction << memory;
    EXPECT_NEAR(at.v[0], -slope * speed, 1e-3 * speed);
    EXPECT_NEAR(at.v[1], -slope * speed, 1e-3 * speed);
    EXPECT_NEAR(std::abs(at.omega[2]) * r, friction > 0.0 ? speed : 0.0, 0.01 * speed);
  }
}

// In a sphere as in a cylinder: along its equator, out of which nothing leads. A circle is that equator.
TEST_F(SlopingWalls, LetASphereRollAroundASphere) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const double speed = 2.0;
  for (const auto& [flat, memory] : {std::pair(false, false), {false, true}, {true, false}, {true, true}}) {
    const VesselShape shape = flat ? VesselShape::circle : VesselShape::sphere;
    input::Input in = in_vessel(test::vacuum(flat ? 2 : 3, 1.0, r, 1e-5, speed), shape, 1.0, 0.0, 1.0);
    in.contact.friction = in.contact.wall_friction = 0.3;
    if (memory) in.contact.tangential = input::Tangential::mindlin;
    Bench bench(comm, in);
    bench.place({0.95 + 1e-5, 0.5, flat ? 0.0 : 0.5}, r, {0.0, speed, 0.0});
    bench.start();
    bench.step(static_cast<std::int64_t>(0.5 / bench.dt()));
    const Bench::State at = bench.state(0);
    const double v = std::hypot(at.v[0], at.v[1]);
    EXPECT_NEAR(v, 5.0 / 7.0 * speed, 0.02) << memory;
    EXPECT_NEAR(std::abs(at.omega[2]) * r, v, 0.02) << memory;
    EXPECT_NEAR(at.x[2], flat ? 0.0 : 0.5, 1e-6);
    EXPECT_NEAR(std::hypot(at.x[0] - 0.5, at.x[1] - 0.5), 0.45, 1e-3);
  }
}

struct Vessel {
  const char* name;
  const char* keys;
  bool flat = false;
  [[nodiscard]] double fraction() const { return flat ? 0.4 : 0.25; }  // of a layer
};
void PrintTo(const Vessel& vessel, std::ostream* out) { *out << vessel.name; }

/// Some hundreds of spheres, or discs, which remember.
std::string text_of(const Vessel& vessel) {
  return std::string("fidelity = \"balanced\"\n[container]\n") + (vessel.flat ? "dimension = 2\n" : "") + vessel.keys +
         "[particles]\ndensity = 1000.0\nyoungs_modulus = 5.0e6\npoisson_ratio = 0.25\n"
         "radius = { distribution = \"equal\", value = 0.01 }\n"
         "[layers]\nthickness = 0.08\nfraction = " +
         std::to_string(vessel.fraction()) +
         "\n[jamming]\ngravity = 9.81\n"
         "[contact]\nfriction = 0.3\ndamping_ratio = 0.3\n[checkpoint]\nevery = \"off\"\n";
}

class PackIn : public test::PacksOnRanks, public ::testing::WithParamInterface<Vessel> {
 protected:
  scene::Scene scene_ = scene::build(input::parse(text_of(GetParam()), "shape.toml", {}));

  void SetUp() override {
    if (world_.size() != 3) GTEST_SKIP() << "on three ranks";
  }
};

TEST_P(PackIn, IsOneOnAnyNumberOfRanksAndAfterAStop) {
  ASSERT_EQ(run(scene_, 1, 0, ""), ExitCode::done);
  const pack::PackRows first = rows();
  EXPECT_EQ(run(scene_, 3, 700, ""), ExitCode::stopped_early);
  EXPECT_EQ(run(scene_, 2, 700, "auto"), ExitCode::stopped_early);
  EXPECT_EQ(run(scene_, 3, 700, "auto"), ExitCode::stopped_early);
  EXPECT_EQ(run(scene_, 1, 0, "auto"), ExitCode::done);
  const pack::PackRows again = rows();
  EXPECT_EQ(again.position, first.position);
  EXPECT_EQ(again.velocity, first.velocity);
  EXPECT_EQ(again.spin, first.spin);
  // Inside, all of it; and full.
  const geometry::Container& vessel = scene_.container;
  const int dimension = vessel.dimension;
  ASSERT_GT(first.id.size(), 150U);
  double solid = 0.0;
  for (std::size_t k = 0; k < first.id.size(); ++k) {
    const Vec3& x = first.position[k];
    EXPECT_LT(vessel.beyond(x), -0.97 * first.radius[k]) << k;
    const double height = x[static_cast<std::size_t>(vessel.vertical())];
    solid += geometry::volume_below(dimension, first.radius[k], height, vessel.height());
  }
  if (world_.rank() != 0) return;
  EXPECT_EQ(record_.audit.outside, 0);
  EXPECT_NEAR(record_.phi, solid / vessel.volume_between(0.0, vessel.height()), 1e-12);
  EXPECT_GT(record_.phi_bulk, dimension == 3 ? 0.48 : 0.74);    // few diameters wide
  EXPECT_LT(record_.phi_bulk, dimension == 3 ? 0.62 : 0.9069);  // equal discs order: the triangular lattice
  for (const report::LayerRow& row : record_.layers) {          // each layer's region is the shape's
    const double room = vessel.volume_between(row.region_bottom, std::min(row.region_bottom + 0.08, 9.0));
    if (vessel.closes()) continue;
    const double one = geometry::volume(dimension, 0.01);
    EXPECT_NEAR(static_cast<double>(row.inserted) * one, GetParam().fraction() * room, one);
  }
  EXPECT_NEAR(record_.rest.support, 1.0, 0.05);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, PackIn,
    ::testing::Values(
        Vessel{"hopper", "shape = \"frustum\"\nbottom_diameter = 0.06\ntop_diameter = 0.16\nheight = 0.12\n"},
        Vessel{"heap", "shape = \"frustum\"\nbottom_diameter = 0.18\ntop_diameter = 0.1\nheight = 0.1\n"},
        Vessel{"sphere", "shape = \"sphere\"\ndiameter = 0.16\nheight = 0.13\n"},
        Vessel{"annulus", "shape = \"annulus\"\ndiameter = 0.16\ninner_diameter = 0.06\nheight = 0.08\n"},
        Vessel{"circle", "shape = \"circle\"\ndiameter = 0.32\nheight = 0.26\n", true},
        Vessel{"wider", "shape = \"trapezium\"\nbottom_width = 0.12\ntop_width = 0.4\nheight = 0.25\n", true},
        Vessel{"narrower", "shape = \"trapezium\"\nbottom_width = 0.36\ntop_width = 0.2\nheight = 0.3\n", true},
        Vessel{"polygon",
               "shape = \"polygon\"\npolygon = [[0.1, 0.0], [0.2, 0.0], [0.36, 0.16], [0.28, 0.3], [0.0, 0.3], [0.0, "
               "0.1]]\n"
               "height = 0.28\n",
               true}));

}  // namespace
}  // namespace packmpi::run
