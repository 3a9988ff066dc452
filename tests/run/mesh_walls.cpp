// What a particle feels of the faces, edges and corners of a vessel of triangles.
#include <gtest/gtest.h>

#include <cmath>

#include "mesh/shapes.hpp"
#include "support/placed_bed.hpp"
#include "support/wall_force.hpp"

namespace packmpi::run {
namespace {

using test::Bench;
using testing::Soup;

constexpr double r = 0.05;

/// A room of 1 x 1 x 1 with a cube in it from 0.4 to 0.6, of many triangles.
Soup room_with_cube(int n) {
  Soup soup = testing::box({0, 0, 0}, {1, 1, 1}, n);
  for (const mesh::Corners& c : testing::box({0.4, 0.4, 0.4}, {0.6, 0.6, 0.6}, n)) soup.push_back(c);
  return soup;
}

input::Input in_mesh(input::Input in, const Soup& soup, double height) {
  input::Container& c = in.container;
  c.shape = input::VesselShape::mesh;
  c.mesh = std::make_shared<const mesh::Surface>(soup, "test");
  c.height = height;
  c.size = {c.mesh->high()[0], c.mesh->high()[1], height};
  return in;
}

void expect_force(const input::Input& in, const Vec3& on_wall, const Vec3& away, double depth) {
  test::expect_force(in, r, on_wall, away, depth);
}

TEST(MeshWalls, PushAsHertzSays) {
  const double depth = 1e-3, s = std::sqrt(0.5), t = std::sqrt(1.0 / 3.0);
  const input::Input in = in_mesh(test::vacuum(3, 1.0, r, 1e-6, 2.0), room_with_cube(4), 1.0);
  expect_force(in, {0.25, 0.25, 0.0}, {0, 0, 1}, depth);     // on the floor, on the corner of eight triangles
  expect_force(in, {0.0, 0.3, 0.7}, {1, 0, 0}, depth);       // beside a wall
  expect_force(in, {0.55, 0.5, 1.0}, {0, 0, -1}, depth);     // below the lid
  expect_force(in, {0.55, 0.6, 0.45}, {0, 1, 0}, depth);     // on a face of the cube
  expect_force(in, {0.6, 0.45, 0.6}, {s, 0, s}, depth);      // on an edge of it
  expect_force(in, {0.6, 0.55, 0.6}, {0.6, 0, 0.8}, depth);  // on that, otherwise
  expect_force(in, {0.6, 0.4, 0.6}, {t, -t, t}, depth);      // on a corner
  expect_force(in, {0.6, 0.4, 0.6}, {0.48, -0.6, 0.64}, depth);
}

/// A sphere rolls over a floor of many triangles as over one plane, to the bit but for the last ones.
TEST(MeshWalls, SeamsAreNotFelt) {
  const comm::Comm comm(MPI_COMM_WORLD);
  std::vector<Bench::State> ends;
  for (const int n : {1, 9}) {
    input::Input in = test::vacuum(3, 1.0, r, 1e-5, 2.0);
    in.jamming.gravity = 20.0;
    in.contact.friction = in.contact.wall_friction = 0.3;
    in.contact.tangential = input::Tangential::mindlin;
    Bench bench(comm, in_mesh(in, testing::box({0, 0, 0}, {1, 1, 1}, n), 1.0));
    bench.place({0.1, 0.13, r - std::pow(test::mass(r) * 20.0 / test::hertz(r, 1.0), 2.0 / 3.0)}, r, {2.8, 2.4, 0.0});
    bench.start();
    bench.step(static_cast<std::int64_t>(0.25 / bench.dt()));
    ends.push_back(bench.state(0));
  }
  EXPECT_GT(ends[0].x[0], 0.6);
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_NEAR(ends[0].x[a], ends[1].x[a], 1e-11);
    EXPECT_NEAR(ends[0].v[a], ends[1].v[a], 1e-10);
    EXPECT_NEAR(ends[0].omega[a], ends[1].omega[a], 1e-8);
  }
  EXPECT_NEAR(std::hypot(ends[0].v[0], ends[0].v[1]), 5.0 / 7.0 * std::hypot(2.8, 2.4), 0.03);
}

}  // namespace
}  // namespace packmpi::run
