// The near field of CC16 eqs. (5)-(6), alone and through a step; the law's constants against their formulas.
#include "dynamics/near_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "support/tiny_world.hpp"

namespace packmpi {
namespace {

using support::plain_scene;
using support::World;

scene::Scene near_scene(int dimension, bool rotation, const input::NearField& law) {
  scene::Scene s = plain_scene(dimension, 0.01);
  s.features.rotation = s.features.friction = rotation;
  s.features.near_field = true;
  s.in.near_field = law;
  return s;
}

/// Sums of two particles at the given places, the second perhaps a ghost.
struct Sums {
  std::vector<std::int64_t> quanta = std::vector<std::int64_t>(16, 0);
  bool in_range = true;
};

Sums of_pair(const scene::Scene& s, const Vec3& first, const Vec3& second, bool ghost = false) {
  particles::Store store(s.features.layout());
  store.add(0, first, 0.01, {}, {});
  store.add(1, second, 0.01, {}, {});
  if (ghost) {
    particles::Store one(s.features.layout());
    one.add(0, first, 0.01, {}, {});
    one.set_ghosts(1);
    std::copy_n(store.record(1), s.features.layout().stride, one.record(1));
    store = std::move(one);
  }
  neighbor::PairList pairs;
  pairs.first = {0};
  pairs.second = {1};
  Sums sums;
  sums.in_range = dynamics::add_near_field(s, store, pairs, sums.quanta.data());
  return sums;
}

TEST(NearField, InversePowers) {
  for (const double d : {0.003, 0.04, 1.0, 7.5}) {
    for (const double exponent : {0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 6.5, 7.0, 12.0, 13.0, -1.0, -2.5}) {
      EXPECT_NEAR(dynamics::inverse_power(d, exponent) / std::pow(d, -exponent), 1.0, 1e-14) << d << ' ' << exponent;
    }
    EXPECT_DOUBLE_EQ(dynamics::inverse_power(d, 2.37), std::pow(d, -2.37));
  }
  EXPECT_EQ(dynamics::inverse_power(0.25, 0.5), 2.0);
  EXPECT_EQ(dynamics::inverse_power(0.5, 3.0), 8.0);
}

TEST(NearField, AttractsAndRepelsAlongTheLineOfCentres) {
  for (const bool rotation : {false, true}) {
    for (const int dimension : {2, 3}) {
      const scene::Scene s = near_scene(dimension, rotation, {1e-3, 2.0, 4e-6, 3.0, 0.2});
      const std::size_t each = dimension == 3 && rotation ? 8 : 4;
      const Sums sums = of_pair(s, {1.0, 2.0, 0.0}, {1.03, 2.04, 0.0});
      const double force = 1e-3 / 0.0025 - 4e-6 / 0.000125;  // distance 0.05
      EXPECT_TRUE(sums.in_range);
      EXPECT_NEAR(static_cast<double>(sums.quanta[0]) * s.force_quantum, 0.6 * force, 1e-8);
      EXPECT_NEAR(static_cast<double>(sums.quanta[1]) * s.force_quantum, 0.8 * force, 1e-8);
      for (std::size_t a = 0; a < each; ++a) EXPECT_EQ(sums.quanta[each + a], -sums.quanta[a]);
      for (std::size_t a = 2; a < each; ++a) EXPECT_EQ(sums.quanta[a], 0);
      const Sums swapped = of_pair(s, {1.03, 2.04, 0.0}, {1.0, 2.0, 0.0});
      for (std::size_t a = 0; a < each; ++a) EXPECT_EQ(swapped.quanta[a], sums.quanta[each + a]);
    }
  }
}

TEST(NearField, GhostsGetNothing) {
  const scene::Scene s = near_scene(3, true, {1e-3, 2.0, 0.0, 0.0, 0.2});
  const Sums both = of_pair(s, {1.0, 2.0, 3.0}, {1.05, 2.0, 3.0});
  const Sums one = of_pair(s, {1.0, 2.0, 3.0}, {1.05, 2.0, 3.0}, true);
  for (std::size_t a = 0; a < 8; ++a) {
    EXPECT_EQ(one.quanta[a], both.quanta[a]);
    EXPECT_EQ(one.quanta[8 + a], 0);
  }
  EXPECT_NE(one.quanta[0], 0);
}

TEST(NearField, EndsAtTheCutoff) {
  const scene::Scene s = near_scene(3, false, {1.0, 1.0, 0.0, 0.0, 0.25});
  EXPECT_NE(of_pair(s, {1.0, 0.0, 0.0}, {1.2499, 0.0, 0.0}).quanta[0], 0);
  EXPECT_EQ(of_pair(s, {1.0, 0.0, 0.0}, {1.25, 0.0, 0.0}).quanta[0], 0);
}

TEST(NearField, ReachesThroughPeriodicFaces) {
  scene::Scene s = near_scene(3, false, {1e-3, 2.0, 0.0, 0.0, 0.2});
  s.features.periodic = true;
  s.container.periodic = {true, false};
  const Sums sums = of_pair(s, {0.02, 1.0, 1.0}, {99.97, 1.0, 1.0});  // distance 0.05 across x = 0
  EXPECT_NEAR(static_cast<double>(sums.quanta[0]) * s.force_quantum, -0.4, 1e-8);
}

TEST(NearField, CoincidenceIsSkippedAndRangeIsTold) {
  const scene::Scene s = near_scene(3, false, {0.0, 0.0, 1e-3, 12.0, 0.2});
  const Sums same = of_pair(s, {1.0, 1.0, 1.0}, {1.0, 1.0, 1.0});
  EXPECT_TRUE(same.in_range);
  EXPECT_EQ(same.quanta[0], 0);
  EXPECT_FALSE(of_pair(s, {1.0, 1.0, 1.0}, {1.0, 1.0, 1.0 + 1e-6}).in_range);
  EXPECT_FALSE(of_pair(s, {1.0, 1.0, 1.0}, {1.0, 1.0, std::numeric_limits<double>::quiet_NaN()}).in_range);
}

TEST(NearField, MovesParticlesInAStep) {
  for (const bool rotation : {false, true}) {
    for (const int dimension : {2, 3}) {
      World world(near_scene(dimension, rotation, {1e-3, 2.0, 0.0, 0.0, 0.2}));
      world.add({50.0, 50.0, 0.0 + (dimension - 2) * 50.0}, {});
      world.add({50.05, 50.0, 0.0 + (dimension - 2) * 50.0}, {});
      world.step();
      const double mass = 1000.0 * 4.0 / 3.0 * std::numbers::pi * 1e-6;
      EXPECT_NEAR(world.velocity(0)[0], 0.4 / mass * 1e-4, 1e-9);
      EXPECT_EQ(world.velocity(0)[0], -world.velocity(1)[0]);
      EXPECT_TRUE(world.near_in_range());
    }
  }
}

TEST(Law, ConstantsOfTheScene) {
  scene::Scene s = plain_scene(3, 0.02);
  s.features.rotation = true;
  support::add_friction(s, 0.2);
  s.in.contact.wall_friction = 0.3;
  s.in.contact.damping_ratio = 0.1;
  const dynamics::Law law = dynamics::make_law(s);
  const double modulus = 1e8 / (2.0 * (1.0 - 0.0625));
  const double mass = 1000.0 * 4.0 / 3.0 * std::numbers::pi * 8e-6;
  EXPECT_DOUBLE_EQ(law.pair.stiffness, 4.0 / 3.0 * modulus);
  EXPECT_DOUBLE_EQ(law.wall.stiffness, 8.0 / 3.0 * modulus);
  EXPECT_DOUBLE_EQ(law.pair.reduced_radius, 0.01);
  EXPECT_DOUBLE_EQ(law.wall.reduced_radius, 0.02);
  EXPECT_DOUBLE_EQ(law.pair.reduced_mass, 0.5 * mass);
  EXPECT_DOUBLE_EQ(law.wall.reduced_mass, mass);
  EXPECT_DOUBLE_EQ(law.pair.friction, 0.2);
  EXPECT_DOUBLE_EQ(law.wall.friction, 0.3);
  EXPECT_DOUBLE_EQ(law.mass_factor / 8e-6, 1.0 / mass);
  EXPECT_DOUBLE_EQ(law.slip_rate, 1e4);
  EXPECT_DOUBLE_EQ(law.slip_mass, 2.0 / 7.0);
  EXPECT_EQ(law.spin_slip, 1.0);
  EXPECT_EQ(law.lowest_force, 0.0);
  // d* = 2 xi sqrt(2 sqrt(r*) E* m*) delta^(1/4), at delta = 1e-5
  const double t = std::sqrt(0.01 * 1e-5);
  EXPECT_NEAR(law.pair.damping * std::sqrt(law.pair.reduced_mass * t),
              0.2 * std::sqrt(2.0 * std::sqrt(0.01) * modulus * 0.5 * mass) * std::pow(1e-5, 0.25), 1e-12);
}

TEST(Law, Choices) {
  scene::Scene s = plain_scene(3, 0.02);
  s.features.rotation = true;
  support::add_friction(s, 0.2);
  s.in.contact.wall = input::WallStiffness::material;
  s.in.contact.tension_cutoff = false;
  s.in.contact.friction_velocity = input::FrictionVelocity::centre;
  s.in.contact.regularisation = input::Regularisation::viscous;
  s.in.contact.slip_time = 0.01;
  const dynamics::Law law = dynamics::make_law(s);
  EXPECT_EQ(law.wall.stiffness, law.pair.stiffness);
  EXPECT_EQ(law.lowest_force, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(law.spin_slip, 0.0);
  EXPECT_EQ(law.slip_mass, 1.0);
  EXPECT_DOUBLE_EQ(law.slip_rate, 100.0);
  s.in.contact.regularisation = input::Regularisation::none;
  EXPECT_GE(dynamics::make_law(s).slip_rate, 1e100);
  s.features.rotation = false;
  s.in.contact.friction_velocity = input::FrictionVelocity::contact;
  EXPECT_EQ(dynamics::make_law(s).slip_mass, 1.0);
}

}  // namespace
}  // namespace packmpi
