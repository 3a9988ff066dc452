// The unbalanced force ratio: by hand, and against what a step of the dynamics makes of the same forces. The same bits
// on any number of ranks.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "comm/exact_sum.hpp"
#include "observe/measure.hpp"
#include "support/placed_bed.hpp"

namespace packmpi::run {
namespace {

using test::Bench;

double ratio_of(const Bench& bench) {
  const Bed& bed = bench.bed();
  return observe::unbalanced_force(bed.comm, bed.store, bench.scene(), bed.stepper.law(), bed.neighborhood);
}

double mass_of(double r) { return 1000.0 * 4.0 / 3.0 * std::numbers::pi * r * r * r; }

TEST(Balance, NothingTouchesIsInfiniteAndNoForceIsNone) {
  const comm::Comm comm(MPI_COMM_WORLD);
  Bench falling(comm, test::small_input(3, 1.0, 0.05));
  falling.place({0.5, 0.5, 0.5}, 0.05);
  falling.start();
  EXPECT_EQ(ratio_of(falling), HUGE_VAL);
  Bench floating(comm, test::vacuum(3, 1.0, 0.05, 1e-5, 0.1));
  floating.place({0.5, 0.5, 0.5}, 0.05);
  floating.start();
  EXPECT_EQ(ratio_of(floating), 0.0);
}

TEST(Balance, OfOneOnTheFloorByHand) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const int dimension : {2, 3}) {
    const double r = 0.05;
    const double weight = mass_of(r) * 2.0;
    const double stiffness = 4.0 / 3.0 * 1e8 / (1.0 - 0.0625) * std::sqrt(r);  // rigid wall
    for (const double share : {1.0, 0.5, 3.0}) {                               // of the weight that the floor bears
      Bench bench(comm, test::small_input(dimension, 1.0, r));
      const double depth = std::pow(share * weight / stiffness, 2.0 / 3.0);
      bench.place(dimension == 3 ? Vec3{0.3, 0.5, r - depth} : Vec3{0.3, r - depth, 0.0}, r);
      bench.start();
      EXPECT_NEAR(ratio_of(bench), std::abs(share - 1.0) / share, 1e-9) << share;
    }
  }
}

// Particles that overlap and slide in mid-air: mean m |dv| / dt of a step, over the mean force of the contacts.
double ratio_by_a_step(Bench& bench, std::int64_t count) {
  const Bed& bed = bench.bed();
  std::vector<double> forces;
  for (const observe::ContactForce& row : observe::contact_forces(bed.store, bench.scene(), bed.neighborhood.pairs())) {
    forces.push_back(std::hypot(row.force[0], row.force[1], row.force[2]));
  }
  const auto contacts = static_cast<double>(bed.comm.sum(std::ssize(forces)));
  const double mean_force = comm::exact_sum(bed.comm, forces) / contacts;
  std::vector<Bench::State> before;
  std::vector<double> radius(static_cast<std::size_t>(count), 0.0);
  for (std::int64_t id = 0; id < count; ++id) before.push_back(bench.state(id));
  for (LocalIndex i = 0; i < bed.store.owned(); ++i) {
    radius[static_cast<std::size_t>(bed.store.ids()[static_cast<std::size_t>(i)])] = bed.store.radius(i);
  }
  bed.comm.max(radius);
  bench.step();
  double sum = 0.0;
  for (std::int64_t id = 0; id < count; ++id) {
    const Vec3 v = bench.state(id).v;
    const Vec3& u = before[static_cast<std::size_t>(id)].v;
    sum += mass_of(radius[static_cast<std::size_t>(id)]) * std::hypot(v[0] - u[0], v[1] - u[1], v[2] - u[2]);
  }
  return sum / bench.dt() / static_cast<double>(count) / mean_force;
}

TEST(Balance, TheForceOnAParticleIsWhatAStepMakesOfIt) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const comm::Comm alone(MPI_COMM_SELF);
  constexpr std::int64_t count = 120;
  for (const bool near_field : {false, true}) {
    for (const int dimension : {2, 3}) {
      input::Input in = test::periodic(test::graded_input(dimension, 1.0, 0.03, 1.5));
      in.drag.coefficient = 0.01;
      in.drag.fluid_velocity = {0.1, 0.2, dimension == 3 ? 0.3 : 0.0};
      if (near_field) in.near_field = input::NearField{1e-4, 2.0, 1e-6, 3.5, 0.12};
      const auto fill = [&](Bench& bench) {
        std::mt19937_64 bits(5);
        const auto u = [&](double low, double high) {
          return low + (high - low) * static_cast<double>(bits() >> 11U) * 0x1p-53;
        };
        for (std::int64_t id = 0; id < count; ++id) {  // a shaken lattice across the periodic faces, off the floor
          const std::array<std::int64_t, 3> at =
              dimension == 3 ? std::array{id % 6, id / 6 % 5, id / 30} : std::array{id % 12, id / 12, std::int64_t{0}};
          Vec3 x{0.7 + 0.075 * static_cast<double>(at[0]), 0.3 + 0.075 * static_cast<double>(at[1]),
                 dimension == 3 ? 0.3 + 0.075 * static_cast<double>(at[2]) : 0.0};
          for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a) x[a] += u(-5e-4, 5e-4);
          x[0] -= std::floor(x[0]);
          const Vec3 v{u(-0.1, 0.1), u(-0.1, 0.1), dimension == 3 ? u(-0.1, 0.1) : 0.0};
          bench.place(x, u(0.037, 0.039), v, {0.0, 0.0, u(-5, 5)});
        }
        bench.start();
      };
      Bench bench(comm, in);
      fill(bench);
      const double got = ratio_of(bench);
      Bench one(alone, in);
      fill(one);
      EXPECT_EQ(got, ratio_of(one));  // to the bit
      EXPECT_GT(got, 0.1);
      const double expected = ratio_by_a_step(bench, count);
      EXPECT_NEAR(got, expected, 1e-6 * expected) << dimension << near_field;
    }
  }
}

}  // namespace
}  // namespace packmpi::run
