// The implicit members of the theta family: exact derivatives, order of convergence, ranks, steps that fail.
#include <gtest/gtest.h>
#include <petscmat.h>

#include <cmath>
#include <random>

#include "implicit/system.hpp"
#include "support/placed_bed.hpp"

namespace packmpi::run {
namespace {

using test::Bench;
using test::vacuum;

class Implicit : public ::testing::Test {
 protected:
  const comm::Comm comm_{MPI_COMM_WORLD};
};

input::Input theta(input::Input in, double value) {
  in.dynamics.theta = value;
  return in;
}

/// log2 of the ratio of errors at dt and dt/2.
double order(double coarse, double fine) { return std::log2(std::fabs(coarse) / std::fabs(fine)); }

/// A cluster of touching particles with velocities and spins, on a periodic floor; the same on any ranks.
void place_cluster(Bench& bench, int dimension, double length, double r, bool graded) {
  std::mt19937 engine(7);
  const auto draw = [&] { return 2.0 * static_cast<double>(engine()) / 4294967296.0 - 1.0; };
  for (int k = 0; k < (dimension == 3 ? 60 : 20); ++k) {
    const double x = (0.5 + 1.93 * (k % 5)) * r, y = (0.97 + 1.93 * (k / 5 % 4)) * r, z = (0.98 + 1.95 * (k / 20)) * r;
    const Vec3 at = dimension == 3 ? Vec3{x, y, z} : Vec3{x, y, 0.0};
    Vec3 v{draw(), draw(), dimension == 3 ? draw() : 0.0};
    const Vec3 omega{dimension == 3 ? 30 * draw() : 0.0, dimension == 3 ? 30 * draw() : 0.0, 30 * draw()};
    bench.place({std::fmod(at[0] + 0.02 * r * draw() + length, length), at[1], at[2]},
                graded ? r * (1.0 + 0.05 * (k % 3)) : r, v, omega);
  }
}

/// R(u + h e) - R(u - h e) over 2 h against the assembled Jacobian times e, for random directions e.
void expect_exact_derivatives(const comm::Comm& comm, const input::Input& in, double r, bool graded) {
  Bench bench(comm, in);
  const int dimension = in.container.dimension;
  place_cluster(bench, dimension, in.container.size[0], r, graded);
  bench.start();
  dynamics::ImplicitSystem system(comm, bench.scene(), bench.store(), bench.neighborhood());
  const dynamics::Law law = dynamics::make_law(bench.scene());
  const auto n = static_cast<std::size_t>(system.owned() * system.unknowns());
  std::vector<double> u(n), up(n), down(n), e(n), plus(n), minus(n);
  system.begin(law, 2e-4, u.data());
  std::mt19937 engine(static_cast<unsigned>(11 + comm.rank()));
  for (std::size_t k = 0; k < n; ++k) {
    e[k] = 2.0 * static_cast<double>(engine()) / 4294967296.0 - 1.0;
    u[k] += 0.01 * e[n - 1 - k];
  }
  constexpr double h = 1e-6;
  for (std::size_t k = 0; k < n; ++k) up[k] = u[k] + h * e[k], down[k] = u[k] - h * e[k];
  system.residual(up.data(), plus.data());
  system.residual(down.data(), minus.data());
  system.set(u.data());
  Mat matrix = system.make_matrix();
  system.jacobian(matrix);
  Vec direction = nullptr, product = nullptr;
  MatCreateVecs(matrix, &direction, &product);
  double* values = nullptr;
  VecGetArray(direction, &values);
  std::copy(e.begin(), e.end(), values);
  VecRestoreArray(direction, &values);
  MatMult(matrix, direction, product);
  VecGetArray(product, &values);
  double largest = 0.0, worst = 0.0;
  for (std::size_t k = 0; k < n; ++k) {
    const double difference = (plus[k] - minus[k]) / (2.0 * h);
    largest = std::max(largest, std::fabs(difference - e[k]));
    worst = std::max(worst, std::fabs(values[k] - difference));
  }
  VecRestoreArray(product, &values);
  EXPECT_GT(comm.max(largest), 1e-2) << "the contacts must matter";
  EXPECT_LT(comm.max(worst), 1e-5 * comm.max(largest)) << dimension << "D";
  VecDestroy(&direction);
  VecDestroy(&product);
  MatDestroy(&matrix);
}

TEST_F(Implicit, JacobianIsTheDerivativeOfTheResidual) {
  for (const int dimension : {2, 3}) {
    for (const bool rotation : {true, false}) {
      input::Input in = theta(test::periodic(test::small_input(dimension, 0.3, 0.02)), 0.5);
      in.dynamics.rotation = rotation;
      in.drag.coefficient = 0.005;
      expect_exact_derivatives(comm_, in, 0.02, false);
    }
    input::Input graded = theta(test::periodic(test::graded_input(dimension, 0.3, 0.02, 1.1)), 1.0);
    graded.near_field = input::NearField{.alpha1 = 1e-3, .beta1 = 2.0, .alpha2 = 1e-5, .beta2 = 3.0, .cutoff = 0.06};
    expect_exact_derivatives(comm_, graded, 0.02, true);
  }
}

/// Free fall with drag for a time of m / c: v = (m g / c)(1 - e^(-c t / m)).
double fall_error(const comm::Comm& comm, double theta_value, int steps) {
  input::Input in = theta(vacuum(3, 0.4, 0.02, 1.0, 1.0), theta_value);
  in.container.size = {0.4, 0.4, 40.0};
  in.jamming.gravity = 2.0;
  const double mass = 1000.0 * 4.0 / 3.0 * M_PI * 8e-6;
  in.drag.coefficient = mass / 0.01;  // 10 ms
  in.dynamics.time_step = 0.01 / steps;
  Bench bench(comm, in);
  bench.place({0.2, 0.2, 30.0}, 0.02);
  bench.start();
  bench.step(steps);
  return bench.state(0).v[2] + 0.02 * (1.0 - std::exp(-1.0));
}

TEST_F(Implicit, FreeFallConvergesInTheOrderOfTheScheme) {
  EXPECT_NEAR(order(fall_error(comm_, 0.5, 16), fall_error(comm_, 0.5, 32)), 2.0, 0.05);
  EXPECT_NEAR(order(fall_error(comm_, 1.0, 64), fall_error(comm_, 1.0, 128)), 1.0, 0.05);
}

/// A sphere that swings on the floor by a tenth of its overlap at rest; its height after about a period.
double swing_height(const comm::Comm& comm, double theta_value, int steps) {
  input::Input in = theta(vacuum(3, 0.4, 0.02, 1.0, 1.0), theta_value);
  in.jamming.gravity = 10.0;
  const double k = 4.0 / 3.0 * 1e8 / (1.0 - 0.0625) * std::sqrt(0.02);
  const double weight = 1000.0 * 4.0 / 3.0 * M_PI * 8e-6 * 10.0;
  const double rest = std::pow(weight / k, 2.0 / 3.0);
  in.dynamics.time_step = 2.0e-3 / steps;
  Bench bench(comm, in);
  bench.place({0.2, 0.2, 0.02 - 0.9 * rest}, 0.02);
  bench.start();
  bench.step(steps);
  return (bench.state(0).x[2] - 0.02) / rest;
}

TEST_F(Implicit, OscillationOnAFloorConvergesInTheOrderOfTheScheme) {
  const double exact = swing_height(comm_, 0.5, 4096);
  EXPECT_NEAR(order(swing_height(comm_, 0.5, 64) - exact, swing_height(comm_, 0.5, 128) - exact), 2.0, 0.2);
  EXPECT_NEAR(order(swing_height(comm_, 1.0, 256) - exact, swing_height(comm_, 1.0, 512) - exact), 1.0, 0.2);
}

TEST_F(Implicit, HertzImpactOfTwoSpheresAcrossTheBorder) {
  input::Input in = theta(vacuum(3, 0.2, 0.01, 1e-7, 20.0), 0.5);  // Chung & Ooi 2011, test 1
  in.particles.density = 2800.0;
  in.particles.youngs_modulus = 48e9;
  in.particles.poisson_ratio = 0.20;
  Bench bench(comm_, in);
  bench.place({0.1 - 0.010001, 0.1, 0.1}, 0.01, {10, 0, 0});
  bench.place({0.1 + 0.010001, 0.1, 0.1}, 0.01, {-10, 0, 0});
  bench.start();
  double deepest = 0.0;
  for (int k = 0; k < 450; ++k) {
    bench.step();
    deepest = std::max(deepest, 0.02 - (bench.state(1).x[0] - bench.state(0).x[0]));
  }
  EXPECT_NEAR(deepest, 274.11e-6, 1e-3 * 274.11e-6);
  EXPECT_NEAR(bench.state(0).v[0], -10.0, 1e-3 * 10.0);
}

/// A sliding sphere ends rolling: v = 5/7 v_0 (physics of friction and spin through the smooth law).
TEST_F(Implicit, SlidingEndsInRolling) {
  input::Input in = theta(vacuum(3, 2.0, 0.02, 2e-4, 1.0), 1.0);
  in.jamming.gravity = 10.0;
  in.contact.damping_ratio = 0.3;
  in.contact.friction = in.contact.wall_friction = 0.2;
  Bench bench(comm_, in);
  bench.place({0.5, 0.5, 0.02 - 1e-6}, 0.02, {0.5, 0, 0});
  bench.start();
  bench.step(1000);  // slip ends after 2 v / (7 mu g) = 71 ms
  EXPECT_NEAR(bench.state(0).v[0], 0.5 * 5.0 / 7.0, 2e-3);
  EXPECT_NEAR(bench.state(0).omega[1] * 0.02, bench.state(0).v[0], 2e-3);
}

/// A bed settles far beyond the explicit step, and ends as on one rank to the solver's tolerance: floor force =
/// weight.
TEST_F(Implicit, PileRestsOnItsFloor) {
  input::Input in = theta(test::small_input(3, 0.2, 0.02), 1.0);
  in.dynamics.time_step = 1e-3;  // eq. (23): 2.5e-4
  in.contact.damping_ratio = 0.5;
  Bench bench(comm_, in);
  for (int k = 0; k < 27; ++k) {
    bench.place({0.03 + 0.05 * (k % 3) + 1e-3 * (k / 9), 0.03 + 0.05 * (k / 3 % 3), 0.03 + 0.045 * (k / 9)}, 0.02);
  }
  bench.start();
  bench.step(3000);
  double mean = 0.0, fastest = 0.0;
  for (GlobalId id = 0; id < 27; ++id) {
    mean += bench.state(id).x[2] / 27.0;
    fastest = std::max(fastest, std::fabs(bench.state(id).v[2]));
  }
  EXPECT_LT(fastest, 0.02);
  EXPECT_GT(mean, 0.02);
  EXPECT_LT(mean, 0.07);
  EXPECT_GT(bench.bed().stepper.implicit()->counters().newton_iterations, 3000);
}

TEST_F(Implicit, AStepThatCannotBeSolvedAtOnceIsHalved) {
  input::Input in = theta(vacuum(3, 0.4, 0.02, 5e-3, 20.0), 0.5);
  in.layers.velocity = {20.0, 0.0, 0.0};
  Bench bench(comm_, in);
  bench.place({0.2 - 0.0205, 0.2, 0.2}, 0.02, {10, 0, 0});
  bench.place({0.2 + 0.0205, 0.2, 0.2}, 0.02, {-10, 0, 0});
  bench.start();
  bench.step(2);  // 50 mm each, beyond any list, and through each other
  EXPECT_GT(bench.bed().stepper.implicit()->counters().halvings, 0);
  EXPECT_LT(bench.state(0).v[0], -5.0) << "they bounced";
  EXPECT_NEAR(bench.state(0).v[0] + bench.state(1).v[0], 0.0, 1e-6);
}

}  // namespace
}  // namespace packmpi::run
