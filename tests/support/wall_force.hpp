/// What a wall does to a sphere that is pressed into it, by Hertz' formula.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/placed_bed.hpp"

namespace packmpi::test {

inline double mass(double r) { return 1000.0 * 4.0 / 3.0 * std::numbers::pi * r * r * r; }
/// [N] Of a rigid wall, for E = 1e8 Pa and nu = 0.25.
inline double hertz(double r, double depth) { return 4.0 / 3.0 * 1e8 / (1.0 - 0.0625) * std::sqrt(r * depth) * depth; }

/// Places a sphere of radius r `depth` deep in a wall, its middle on the line from a point of it along `away` into the
/// vessel; what one step gives is the wall's force.
inline void expect_force(const input::Input& in, double r, const Vec3& on_wall, const Vec3& away, double depth) {
  const comm::Comm comm(MPI_COMM_WORLD);
  Bench bench(comm, in);
  Vec3 x{};
  for (std::size_t a = 0; a < 3; ++a) x[a] = on_wall[a] + (r - depth) * away[a];
  bench.place(x, r);
  bench.start();
  bench.step();
  const Bench::State at = bench.state(0);
  const double speed = hertz(r, depth) * bench.dt() / mass(r);
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(at.v[a], speed * away[a], 1e-9 * speed) << a;
}

}  // namespace packmpi::test
