// The exact targets of the contact law through the whole step loop (kernel, ghosts, lists), to 0.1 %, on one and two
// ranks: contacts lie across the border of the two ranks. Sources: CC16; Chung & Ooi 2011 tests 1, 2, 4 to 6.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

#include "support/placed_bed.hpp"

namespace packmpi::run {
namespace {

using test::Bench;
using test::vacuum;

constexpr double tolerance = 1e-3;

class Targets : public ::testing::TestWithParam<int> {
 protected:
  const comm::Comm comm_{MPI_COMM_WORLD};
  const int dimension_ = GetParam();
  // A position at height h (vertical axis) and lateral x, in the middle of y.
  [[nodiscard]] Vec3 at(double x, double h, double width) const {
    return dimension_ == 3 ? Vec3{x, 0.5 * width, h} : Vec3{x, h, 0.0};
  }
  [[nodiscard]] double vertical(const Vec3& v) const { return v[static_cast<std::size_t>(dimension_ - 1)]; }
  [[nodiscard]] Vec3 up(double v) const { return dimension_ == 3 ? Vec3{0, 0, v} : Vec3{0, v, 0}; }
  // Component of a spin about the axis that rolls along +x.
  [[nodiscard]] double roll(const Vec3& omega) const { return dimension_ == 3 ? omega[1] : -omega[2]; }
};

TEST_P(Targets, TwoGlassSpheresHeadOn) {
  input::Input in = vacuum(dimension_, 0.2, 0.01, 2e-8, 20.0);
  in.particles.density = 2800.0;
  in.particles.youngs_modulus = 48e9;
  in.particles.poisson_ratio = 0.20;
  Bench bench(comm_, in);
  bench.place(at(0.1 - 0.010001, 0.1, 0.2), 0.01, {10, 0, 0});
  bench.place(at(0.1 + 0.010001, 0.1, 0.2), 0.01, {-10, 0, 0});
  bench.start();
  double deepest = 0.0, strongest = 0.0, duration = 0.0;
  for (int k = 0; k < 2200; ++k) {
    bench.step();
    const double overlap = 0.02 - (bench.state(1).x[0] - bench.state(0).x[0]);
    deepest = std::max(deepest, overlap);
    strongest = std::max(strongest, bench.force());
    if (overlap > 0.0) duration += bench.dt();
  }
  EXPECT_NEAR(deepest, 274.11e-6, tolerance * 274.11e-6);
  EXPECT_NEAR(strongest, 10.697e3, tolerance * 10.697e3);
  EXPECT_NEAR(duration, 40.34e-6, tolerance * 40.34e-6 + in.dynamics.time_step.value());
  EXPECT_NEAR(bench.state(0).v[0], -10.0, tolerance * 10.0);
  EXPECT_EQ(bench.state(0).v[0], -bench.state(1).v[0]);  // momentum to the bit
}

TEST_P(Targets, AluminiumSphereOnARigidPlane) {
  input::Input in = vacuum(dimension_, 1.0, 0.1, 2e-7, 0.2);
  in.particles.density = 2699.0;
  in.particles.youngs_modulus = 70e9;
  in.particles.poisson_ratio = 0.30;
  Bench bench(comm_, in);
  bench.place(at(0.5, 0.1000001, 1.0), 0.1, up(-0.2));
  bench.start();
  double deepest = 0.0, strongest = 0.0, duration = 0.0;
  for (int k = 0; k < 4000; ++k) {
    bench.step();
    const double overlap = 0.1 - vertical(bench.state(0).x);
    deepest = std::max(deepest, overlap);
    strongest = std::max(strongest, bench.force());
    if (overlap > 0.0) duration += bench.dt();
  }
  EXPECT_NEAR(deepest, 49.717e-6, tolerance * 49.717e-6);
  EXPECT_NEAR(strongest, 11.370e3, tolerance * 11.370e3);
  EXPECT_NEAR(duration, 731.7e-6, tolerance * 731.7e-6 + in.dynamics.time_step.value());
}

TEST_P(Targets, RestitutionDoesNotDependOnTheImpactSpeed) {
  for (const double xi : {0.1, 0.4}) {
    std::map<double, double> e;
    for (const double speed : {0.02, 0.2, 2.0}) {
      input::Input in = vacuum(dimension_, 0.4, 0.02, 2e-7, speed);
      in.contact.damping_ratio = xi;
      Bench bench(comm_, in);
      bench.place(at(0.2 - 0.0200001, 0.2, 0.4), 0.02, {0.5 * speed, 0, 0});
      bench.place(at(0.2 + 0.0200001, 0.2, 0.4), 0.02, {-0.5 * speed, 0, 0});
      bench.start();
      for (int k = 0; k < 400 && bench.state(1).v[0] - bench.state(0).v[0] <= 0.0; ++k) bench.step(100);
      bench.step(static_cast<std::int64_t>(4e-3 / in.dynamics.time_step.value()));
      e[speed] = (bench.state(1).v[0] - bench.state(0).v[0]) / speed;
    }
    EXPECT_NEAR(e[0.02], e[0.2], tolerance);
    EXPECT_NEAR(e[2.0], e[0.2], tolerance);
    EXPECT_LT(e[0.2], 0.99);
    EXPECT_GT(e[0.2], 0.1);
  }
}

// A sphere thrown at the floor: V_t along +x, V_n down. Returns its state after the impact.
Bench::State thrown(const comm::Comm& comm, int dimension, double vt, double vn, double mu, const Vec3& start,
                    const Vec3& down) {
  input::Input in = vacuum(dimension, 0.4, 0.02, 2e-7, vt + vn);
  in.contact.friction = in.contact.wall_friction = mu;
  Bench bench(comm, in);
  Vec3 v = down;
  for (double& c : v) c *= vn;
  v[0] = vt;
  bench.place(start, 0.02, v);
  bench.start();
  bench.step(40000);  // 8 ms: the contact lasts below 2 ms
  return bench.state(0);
}

TEST_P(Targets, ObliqueImpactInGrossSlip) {
  const double mu = 0.2, vn = 0.5, vt = 1.0;  // tan = 2 >= 7/2 mu (1 + e) = 1.4
  const double e = 1.0;
  const auto s = thrown(comm_, dimension_, vt, vn, mu, at(0.1999, 0.0200001, 0.4), up(-1.0));
  EXPECT_NEAR(vertical(s.v), e * vn, tolerance * vn);
  EXPECT_NEAR(s.v[0], vt - mu * (1.0 + e) * vn, tolerance * vt);
  EXPECT_NEAR(roll(s.omega) * 0.02, 2.5 * mu * (1.0 + e) * vn, tolerance * vt);
  EXPECT_NEAR(s.v[0] - roll(s.omega) * 0.02, vt - 3.5 * mu * (1.0 + e) * vn, tolerance * vt);
}

TEST_P(Targets, SteepImpactEndsRolling) {
  const double mu = 0.5, vn = 1.0, vt = 0.5;
  const auto s = thrown(comm_, dimension_, vt, vn, mu, at(0.1999, 0.0200001, 0.4), up(-1.0));
  EXPECT_NEAR(s.v[0], 5.0 / 7.0 * vt, tolerance * vt);
  EXPECT_NEAR(s.v[0] - roll(s.omega) * 0.02, 0.0, tolerance * vt);
}

TEST_P(Targets, SlidingSphereStartsToRoll) {
  input::Input in = vacuum(dimension_, 1.0, 0.02, 1e-6, 0.2);
  in.contact.friction = in.contact.wall_friction = 0.3;
  in.jamming.gravity = 10.0;
  in.contact.damping_ratio = 0.1;
  const double v0 = 0.2;
  const double k = 4.0 / 3.0 * 1e8 / (1.0 - 0.0625) * std::sqrt(0.02);
  const double weight = 1000.0 * 4.0 / 3.0 * std::numbers::pi * 8e-6 * 10.0;
  Bench bench(comm_, in);
  bench.place(at(0.495, 0.02 - std::pow(weight / k, 2.0 / 3.0), 1.0), 0.02, {v0, 0, 0});  // resting; crosses the border
  bench.start();
  const double expected = 2.0 * v0 / (7.0 * 0.3 * 10.0);
  double rolled = 0.0;
  for (int step = 0; step < 40000 && rolled == 0.0; ++step) {
    bench.step();
    const auto s = bench.state(0);
    if (s.v[0] - roll(s.omega) * 0.02 < 1e-9) rolled = (step + 1) * in.dynamics.time_step.value();
  }
  EXPECT_NEAR(rolled, expected, tolerance * expected);
  bench.step(5000);
  EXPECT_NEAR(bench.state(0).v[0], 5.0 / 7.0 * v0, tolerance * v0);
}

TEST_P(Targets, ColumnOfSpheresCarriesItsWeight) {
  const int n = 5;
  input::Input in = vacuum(dimension_, 0.4, 0.02, 2e-5, 0.1);
  in.jamming.gravity = 10.0;
  in.contact.damping_ratio = 0.5;
  Bench bench(comm_, in);
  for (int k = 0; k < n; ++k) bench.place(at(0.2 + (dimension_ == 3 ? 1e-9 : 0.0), 0.02 + 0.04 * k, 0.4), 0.02);
  bench.start();
  bench.step(50000);  // 1 s
  const double weight = 1000.0 * 4.0 / 3.0 * std::numbers::pi * 8e-6 * 10.0;
  const double stiffness = 4.0 / 3.0 * 1e8 / (2.0 * (1.0 - 0.0625)) * std::sqrt(0.01);
  for (int k = 1; k < n; ++k) {  // k-th contact from the top, between n-1-k and n-k
    const double overlap = 0.04 - (vertical(bench.state(n - k).x) - vertical(bench.state(n - 1 - k).x));
    const double expected = std::pow(k * weight / stiffness, 2.0 / 3.0);
    EXPECT_NEAR(overlap, expected, tolerance * expected) << k;
  }
  const double floor = 0.02 - vertical(bench.state(0).x);
  const double rigid = 4.0 / 3.0 * 1e8 / (1.0 - 0.0625) * std::sqrt(0.02);
  EXPECT_NEAR(rigid * std::pow(floor, 1.5), n * weight, tolerance * n * weight);  // floor force = total weight
}

TEST_P(Targets, FreeFallWithDrag) {
  input::Input in = vacuum(dimension_, 4.0, 0.02, 1e-5, 0.1);
  in.jamming.gravity = 10.0;
  in.drag.coefficient = 0.1;
  const double m = 1000.0 * 4.0 / 3.0 * std::numbers::pi * 8e-6;
  Bench bench(comm_, in);
  bench.place(at(2.0, 3.9, 4.0), 0.02);
  bench.start();
  bench.step(60000);  // 0.6 s, about two relaxation times
  const double t = 0.6;
  const double expected = m * 10.0 / 0.1 * (1.0 - std::exp(-0.1 * t / m));
  EXPECT_NEAR(-vertical(bench.state(0).v), expected, tolerance * expected);
}

INSTANTIATE_TEST_SUITE_P(Dimensions, Targets, ::testing::Values(2, 3));

}  // namespace
}  // namespace packmpi::run
