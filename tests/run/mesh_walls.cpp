// What a particle feels of the faces, edges and corners of a vessel of triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <utility>

#include "mesh/shapes.hpp"
#include "support/placed_bed.hpp"
#include "support/wall_force.hpp"

namespace packmpi::run {
namespace {

using test::Bench;
using testing::Soup;

constexpr double r = 0.05;

/// An interior of 1 x 1 x 1 with a cube in it from 0.4 to 0.6, of many triangles.
Soup box_around_cube(int n) {
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
  const input::Input in = in_mesh(test::vacuum(3, 1.0, r, 1e-6, 2.0), box_around_cube(4), 1.0);
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

/// A lying pipe of length 1 and radius 0.5: strips of triangles, between two ends.
Soup pipe(int strips, int cuts) {
  Soup soup;
  const auto at = [&](double x, int k) {
    const double angle = 2.0 * std::numbers::pi * (k + 0.5) / strips;
    return Vec3{x, 0.5 + 0.5 * std::cos(angle), 0.5 + 0.5 * std::sin(angle)};
  };
  for (int k = 0; k < strips; ++k) {
    testing::add_quad(soup, at(0, k), at(1, k), at(1, k + 1), at(0, k + 1), cuts);
    for (int c = 0; c < cuts; ++c) {
      const auto between = [&](double x, int step) {
        const Vec3 a = at(x, k), b = at(x, k + 1);
        return mesh::plus(a, mesh::times(double(step) / cuts, mesh::minus(b, a)));
      };
      soup.push_back({Vec3{0, 0.5, 0.5}, between(0, c), between(0, c + 1)});
      soup.push_back({Vec3{1, 0.5, 0.5}, between(1, c + 1), between(1, c)});
    }
  }
  return soup;
}

/// A sphere that rolls in a pipe of triangles touches it once, and its friction goes on from strip to strip.
TEST(MeshWalls, ARoundWallIsTouchedOnceAndRemembers) {
  const comm::Comm comm(MPI_COMM_WORLD);
  constexpr double g = 20.0, depth = 0.02 * r, start = 0.26;  // [rad] from the lowest line
  input::Input in = test::vacuum(3, 1.0, r, 1e-5, 2.0);
  in.particles.youngs_modulus *= test::mass(r) * g / test::hertz(r, depth);
  in.jamming.gravity = g;
  in.contact.friction = in.contact.wall_friction = 0.5;
  in.contact.damping_ratio = 0.3;
  in.contact.tangential = input::Tangential::mindlin;
  Bench bench(comm, in_mesh(in, pipe(100, 5), 1.0));
  const double way = 0.5 - r + depth;
  bench.place({0.4, 0.5 - way * std::sin(start), 0.5 - way * std::cos(start)}, r);
  bench.start();
  Vec3 before{};
  double most = 0.0, jump = 0.0;
  std::int64_t strips = 0;
  std::int64_t last = -1;
  for (double t = 0.0; t < 0.45; t += bench.dt()) {
    bench.step();
    const neighbor::WallList& walls = bench.neighborhood().walls();
    const auto& memory = bench.neighborhood().memory();
    Vec3 spring{};
    std::int64_t touched = 0;
    for (std::size_t w = 0; w < walls.particle.size(); ++w) {
      for (std::size_t c = 0; c < 3; ++c) spring[c] += memory.of_walls()[c * walls.particle.size() + w];
      if (walls.facing[w].distance >= r) continue;
      ++touched;
      strips += static_cast<std::int64_t>(std::exchange(last, static_cast<std::int64_t>(walls.wall[w])) != last);
    }
    ASSERT_LE(touched, 1);
    jump = std::max(jump, norm(mesh::minus(spring, before)));
    most = std::max(most, norm(spring));
    before = spring;
  }
  if (bench.store().owned() == 0) return;
  const Bench::State end = bench.state(0);
  EXPECT_GT(end.x[1], 0.55);  // on the other side
  EXPECT_GT(strips, 6);
  EXPECT_GT(most, 1e-6);
  EXPECT_LT(jump, 0.02 * most);  // it would begin anew at each edge
}

/// The wall's push on a sphere, over Hertz' at an overlap of a radius.
Vec3 push_at(Bench& bench, const Vec3& x) {
  particles::Store& store = bench.store();
  std::ranges::copy(x, store.record(0) + store.layout().position);
  bench.start();
  const neighbor::WallList& walls = bench.neighborhood().walls();
  Vec3 sum{};
  for (const geometry::Facing& at : walls.facing) {
    if (at.distance < r) sum = mesh::minus(sum, mesh::times(std::pow(1.0 - at.distance / r, 1.5), at.normal));
  }
  return sum;
}

/// In a pipe and around a ball in it, a sphere's force follows its place, however deep it is and whatever it is above,
/// and is the one of the nearest place there.
TEST(MeshWalls, TheForceOfRoundWallsDoesNotJump) {
  const comm::Comm comm(MPI_COMM_WORLD);
  Soup soup = pipe(28, 3);
  for (const mesh::Corners& c : testing::moved(testing::ball(3), [](const Vec3& x) {
         return Vec3{0.5 + 0.15 * x[0], 0.5 + 0.15 * x[1], 0.5 + 0.15 * x[2]};
       })) {
    soup.push_back({c[0], c[2], c[1]});
  }
  const input::Input in = in_mesh(test::vacuum(3, 1.0, r, 1e-6, 2.0), soup, 1.0);
  const mesh::Surface& interior = *in.container.mesh;
  Bench bench(comm, in);
  bench.place({0.5, 0.5, 0.1}, r);
  std::mt19937 dice(1);
  std::uniform_real_distribution<double> any(-1.0, 1.0);
  constexpr double stride = 1e-3 * r, deepest = 0.08;
  int together = 0;
  for (const double from : {0.05, 0.3}) {  // at the pipe, at the ball
    Vec3 x{0.5, 0.5, from}, way{}, before{};
    for (int step = 0; step < 30000; ++step) {
      const mesh::Nearest at = interior.nearest(x);
      const Vec3 off = mesh::unit(mesh::minus(x, at.place));
      if (step % 3000 == 0) way = {0.1 * any(dice), any(dice), any(dice)};
      const double out = at.distance > r                     ? -1.0
                         : at.distance < (1.0 - deepest) * r ? 1.0
                                                             : 0.2 * std::sin(0.003 * step);
      Vec3 along = mesh::minus(way, mesh::times(dot(way, off), off));
      along = mesh::plus(mesh::unit(along), mesh::times(out, off));
      x = mesh::plus(x, mesh::times(stride / norm(along), along));
      const Vec3 push = push_at(bench, x);
      if (step > 0) {
        ASSERT_LT(norm(mesh::minus(push, before)), 3.0 * stride / r * std::sqrt(deepest)) << step << ' ' << from;
      }
      const double overlap = 1.0 - interior.nearest(x).distance / r;
      ASSERT_NEAR(norm(push), overlap > 0.0 ? std::pow(overlap, 1.5) : 0.0, 1e-9) << step;
      together += static_cast<int>(overlap > 0.0 && std::abs(dot(push, off) / norm(push)) < 1.0 - 1e-6);
      before = push;
    }
  }
  EXPECT_GT(together, 1000);  // of several strips
}

}  // namespace
}  // namespace packmpi::run
