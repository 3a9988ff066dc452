// Friction with memory, rolling and twisting resistance: problems with exact answers, on the kernel itself.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "support/tiny_world.hpp"

namespace packmpi {
namespace {

using support::add_memory;
using support::plain_scene;
using support::World;

constexpr double permille = 1e-3;
constexpr double r = 0.01;  // [m]
constexpr double gravity = 2.0;

#define EXPECT_WITHIN(value, exact) EXPECT_NEAR(value, exact, permille* std::abs(exact))

struct Shape {
  int dimension;
  bool graded;
};
constexpr Shape shapes[] = {{2, false}, {2, true}, {3, false}, {3, true}};

double mass(double radius) { return 1000.0 * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius; }

scene::Scene rough_scene(const Shape& shape, double friction, double rolling = 0.0, double twisting = 0.0) {
  scene::Scene s = plain_scene(shape.dimension, r);
  if (shape.graded) support::make_graded(s, 0.5 * r, 2.0 * r);
  add_memory(s, friction, rolling, twisting);
  return s;
}

std::size_t up(const scene::Scene& s) { return static_cast<std::size_t>(s.container.vertical()); }

/// A sphere at rest on a floor under gravity turned by atan(slope), at the depth of its load.
World on_slope(scene::Scene s, double slope, double radius) {
  s.in.contact.damping_ratio = 0.2;
  s.force_quantum = 0x1p-46;
  s.time_step = 5e-5;
  const double normal = gravity / std::hypot(1.0, slope);
  const double k = 4.0 / 3.0 * 1e8 / (1.0 - 0.0625) * std::sqrt(radius);
  Vec3 x{0.1, 0.1, 0.0}, g{slope * normal, 0.0, 0.0};
  x[up(s)] = radius - std::pow(mass(radius) * normal / k, 2.0 / 3.0);
  g[up(s)] = -normal;
  World world(s);
  world.set_gravity(g);
  world.add(x, {}, radius);
  return world;
}

TEST(FrictionWithMemory, SphereStaysOnASlopeBelowFrictionAndSlidesAbove) {
  constexpr double mu = 0.4;
  for (const Shape& shape : shapes) {
    scene::Scene s = rough_scene(shape, mu);
    s.features.rotation = false;
    {
      World world = on_slope(s, 0.99 * mu, r);
      world.run(1.0);
      const Vec3 before = world.position(0);
      const double displacement = world.stored_at_floor(0);
      for (int step = 0; step < 1000000; ++step) world.step();
      EXPECT_NEAR(world.position(0)[0], before[0], 1e-12 * r);
      EXPECT_NEAR(world.stored_at_floor(0), displacement, 1e-12 * std::abs(displacement));
      const double elastic = mass(r) * gravity * 0.99 * mu / std::hypot(1.0, 0.99 * mu);
      const double overlap = r - world.up(0);
      const double k = 8.0 * 1e8 / (2.0 * 1.25 * 1.75) * std::sqrt(r * overlap);
      EXPECT_WITHIN(std::abs(displacement), elastic / k);
    }
    World world = on_slope(s, 1.5 * mu, r);
    const double normal = gravity / std::hypot(1.0, 1.5 * mu);
    world.run(0.1);
    const double early = world.velocity(0)[0];
    world.run(0.5);
    EXPECT_WITHIN(world.velocity(0)[0] - early, 0.5 * (1.5 * mu - mu) * normal);
  }
}

TEST(FrictionWithMemory, WhatHoldsTheSphereIsObserved) {
  for (const Shape& shape : shapes) {
    scene::Scene s = rough_scene(shape, 0.5, 0.5);
    s.features.rotation = true;
    World world = on_slope(s, 0.3, r);
    world.run(2.0);
    const dynamics::ContactEffect seen = dynamics::wall_contact(world.scene(), world.law(), world.store(), 0,
                                                                neighbor::Wall::floor, world.stored_walls());
    const double normal = mass(r) * gravity / std::hypot(1.0, 0.3);
    EXPECT_NEAR(seen.force[0], -0.3 * normal, 1e-9 * normal);
    EXPECT_NEAR(seen.force[up(s)], normal, 1e-9 * normal);
    EXPECT_NEAR(seen.normal, normal, 1e-9 * normal);
    const std::size_t about = shape.dimension == 3 ? 1 : 2;
    EXPECT_NEAR(std::abs(seen.torque[about]), 0.3 * normal * r, 1e-9 * normal * r);
    const double k = 8.0 * 1e8 / (2.0 * 1.25 * 1.75) * std::sqrt(r * (r - world.up(0)));
    EXPECT_WITHIN(seen.spring_energy, 2.0 * 0.5 * std::pow(0.3 * normal, 2.0) / k);  // slip and rolling alike
  }
}

TEST(FrictionWithMemory, SphereRollsOnASlopeAboveRollingFrictionOnly) {
  constexpr double mu_r = 0.2;
  for (const Shape& shape : shapes) {
    for (const double radius : {r, shape.graded ? 0.7 * r : r}) {
      scene::Scene s = rough_scene(shape, 0.8, mu_r);
      s.features.rotation = true;
      {
        World world = on_slope(s, 0.98 * mu_r, radius);
        world.run(2.0);
        const Vec3 before = world.position(0);
        for (int step = 0; step < 1000000; ++step) world.step();
        EXPECT_NEAR(world.position(0)[0], before[0], 1e-12 * radius);
      }
      World world = on_slope(s, 1.5 * mu_r, radius);
      const double normal = gravity / std::hypot(1.0, 1.5 * mu_r);
      world.run(0.1);
      const double early = world.velocity(0)[0];
      world.run(0.5);
      EXPECT_WITHIN(world.velocity(0)[0] - early, 0.5 * 5.0 / 7.0 * 0.5 * mu_r * normal);
      // It rolls: no slip but the elastic one.
      const double spin = shape.dimension == 3 ? world.store().spin(0)[1] : -world.store().spin(0)[2];
      EXPECT_WITHIN(radius * spin, world.velocity(0)[0]);
    }
  }
}

TEST(FrictionWithMemory, SpinAboutTheNormalIsStoppedByTwistingFrictionAlone) {
  constexpr double mu_t = 0.05;
  constexpr double spin = 20.0;  // [rad/s]
  for (const bool graded : {false, true}) {
    scene::Scene s = rough_scene({3, graded}, 0.5, 0.1, mu_t);
    s.features.rotation = true;
    World world = on_slope(s, 0.0, r);
    const double slowing = mu_t * gravity * r / (0.4 * r * r);  // of a torque mu_t m g r
    world = on_slope(s, 0.0, r);
    double* record = world.store().record(0);
    record[world.store().layout().spin + 2] = r * spin;
    world.run(0.3);
    EXPECT_WITHIN(world.store().spin(0)[2], spin - slowing * 0.3);
    world.run(2.0 * spin / slowing);
    EXPECT_NEAR(world.store().spin(0)[2], 0.0, 1e-9 * spin);
  }
}

/// What a sphere that meets a floor at an angle leaves with: velocities of its centre, and that of its lowest point.
struct Rebound {
  double up, along, contact;
};

Rebound impact(const Shape& shape, double mu, double damping, double fall, double along) {
  scene::Scene s = rough_scene(shape, mu);
  s.features.rotation = true;
  s.in.contact.damping_ratio = damping;
  s.in.jamming.gravity = 0.0;
  s.time_step = 1e-7;
  World world(s);
  Vec3 x{0.1, 0.1, 0.0}, v{along, 0.0, 0.0};
  x[up(s)] = r + 1e-9;
  v[up(s)] = -fall;
  world.add(x, v, r);
  while (world.up(0) < r + 2e-9) world.step();
  const double spin = shape.dimension == 3 ? world.store().spin(0)[1] : -world.store().spin(0)[2];
  return {world.velocity(0)[up(s)], world.velocity(0)[0], world.velocity(0)[0] - r * spin};
}

/// The same by the law's differential equations in fine steps: overlap z, slip w, force of the spring.
Rebound integrated(double mu, double damping, double fall, double along) {
  const double m = mass(r), dt = 2e-9;
  const double modulus = 1e8 / (1.0 - 0.0625), shear = 8.0 * 1e8 / (2.0 * 1.25 * 1.75);
  double z = 0.0, rate = fall, w = along, spring = 0.0, impulse = 0.0;
  while (z >= 0.0) {
    const double a = std::sqrt(r * z);
    const double k = shear * a;
    const double eta = 2.0 * damping * std::sqrt(k * m * 2.0 / 7.0);
    const double f =
        std::max(0.0, 4.0 / 3.0 * modulus * a * z + 2.0 * damping * std::sqrt(2.0 * modulus * a * m) * rate);
    // Unloading: the displacement stays while the stiffness falls, d(spring) = spring da / a.
    if (rate < 0.0 && z > 0.0) spring += spring * 0.5 * rate / z * dt;
    const double trial = spring + k * w * dt + eta * w;
    const double t = std::clamp(trial, -mu * f, mu * f);
    if (k > 0.0) spring += k * dt * (t - spring) / (k * dt + eta);
    w -= 3.5 * t / m * dt;
    impulse += t * dt;
    rate -= f / m * dt;
    z += rate * dt;
  }
  return {-rate, along - impulse / m, w};
}

// Chung & Ooi 2011, tests 4 to 6: sliding throughout, and below.
TEST(FrictionWithMemory, ObliqueImpactSlidesOrSticksAsItShould) {
  constexpr double mu = 0.3, fall = 0.2;
  for (const Shape& shape : shapes) {
    for (const double damping : {0.0, 0.1}) {
      for (const double slope : {0.1, 0.3, 0.6, 0.9, 1.2, 2.5, 4.0}) {
        const Rebound seen = impact(shape, mu, damping, fall, slope * fall);
        const Rebound exact = integrated(mu, damping, fall, slope * fall);
        EXPECT_WITHIN(seen.up, exact.up);
        EXPECT_WITHIN(seen.along, exact.along) << slope;
        EXPECT_NEAR(seen.contact, exact.contact, permille * slope * fall) << slope;
        if (slope < 3.5 * mu * 2.0) continue;
        const double e = seen.up / fall;
        EXPECT_WITHIN(seen.along, slope * fall - mu * (1.0 + e) * fall);
        EXPECT_WITHIN(seen.contact, slope * fall - 3.5 * mu * (1.0 + e) * fall);
      }
    }
  }
}

// Maw, Barber & Fawcett 1976, without damping: after steep impacts, which stick, the lowest point goes on; flatter ones
// send it back, most where they slide but for their end; beyond psi = 4 chi, chi = 7/2 (1 - nu) / (2 - nu), they slide
// throughout.
TEST(FrictionWithMemory, ObliqueImpactSpringsBackAsElasticSpheresDo) {
  constexpr double mu = 0.3, fall = 0.2;
  constexpr double chi = 3.5 * 0.75 / 1.75;
  const double scale = 2.0 * 0.75 / (mu * 1.75);  // psi = 2 (1 - nu) / (mu (2 - nu)) tan
  double least = 0.0, least_at = 0.0;
  for (double psi = 0.25; psi < 8.0; psi += 0.25) {
    const double after = scale * impact({3, false}, mu, 0.0, fall, psi / scale * fall).contact / fall;
    if (after < least) least = after, least_at = psi;
    if (psi < 0.8) {
      EXPECT_GT(after, 0.0) << psi;
    }
    if (psi > 2.0 && psi < 4.0 * chi - 0.1) {
      EXPECT_LT(after, 0.0) << psi;
    }
    if (psi > 4.0 * chi) {
      EXPECT_NEAR(after, psi - 4.0 * chi, permille * psi);
    }
  }
  EXPECT_LT(least, -0.8);
  EXPECT_GT(least, -1.5);
  EXPECT_GT(least_at, 2.5);
  EXPECT_LT(least_at, 5.0);
}

/// Moves the second of two spheres, or the only one on the floor, along a path, whatever the forces, and tells what the
/// contact does.
class Rig {
 public:
  Rig(const scene::Scene& scene, bool wall) : world_(scene), wall_(wall), last_(wall ? 0 : 1) {
    world_.add({50.0, 50.0, 50.0}, {}, r);
    if (!wall) world_.add({50.0, 50.0, 50.0}, {}, r);
    if (wall) world_.store().record(0)[up(scene)] = 0.0;
  }

  /// Puts the moved sphere `overlap` deep and `aside` along the tangent; the path between was straight. The contact's
  /// work on it since the step before [J].
  double go(double overlap, double aside) {
    const double dt = world_.scene().time_step;
    const auto v = static_cast<std::size_t>(up(world_.scene()));
    Vec3 x{50.0, 50.0, 50.0};
    x[0] += aside;
    x[v] = wall_ ? r - overlap : x[v] + 2.0 * r - overlap;
    if (world_.scene().container.dimension == 2) x[2] = 0.0;
    if (!wall_) hold(0);
    double* record = world_.store().record(last_);
    for (int a = 0; a < world_.scene().container.dimension; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      record[a] = x[axis];
      record[world_.store().layout().velocity + a] = started_ ? (x[axis] - before_[axis]) / dt : 0.0;
    }
    const Vec3 u = world_.velocity(last_);
    world_.step();
    const Vec3 w = world_.velocity(last_);
    double work = 0.0;
    Vec3 force{};
    for (std::size_t a = 0; a < 3; ++a) {
      force[a] = mass(r) * (w[a] - u[a]) / dt;
      if (started_) work += 0.5 * (force[a] + force_[a]) * (x[a] - before_[a]);
    }
    before_ = x;
    force_ = force;
    started_ = true;
    return work;
  }
  [[nodiscard]] double pull() const { return force_[0]; }
  [[nodiscard]] double push() const { return force_[static_cast<std::size_t>(up(world_.scene()))]; }

 private:
  void hold(LocalIndex i) {
    double* record = world_.store().record(i);
    for (int a = 0; a < world_.scene().container.dimension; ++a) {
      record[a] = 50.0;
      record[world_.store().layout().velocity + a] = 0.0;
    }
  }
  World world_;
  bool wall_;
  LocalIndex last_;
  bool started_ = false;
  Vec3 before_{}, force_{};
};

scene::Scene rig_scene(const Shape& shape, double friction, double damping) {
  scene::Scene s = rough_scene(shape, friction);
  s.features.rotation = false;
  s.in.contact.damping_ratio = damping;
  s.in.jamming.gravity = 0.0;
  s.force_quantum = 0x1p-44;
  s.time_step = 1e-5;
  return s;
}

// Closed paths of overlap and tangential displacement with a slider that slips or not, on a wall, which stays flat.
TEST(FrictionWithMemory, NoLoadCycleGivesEnergy) {
  std::mt19937_64 dice(7);
  const auto random = [&] { return static_cast<double>(dice() >> 11) * 0x1p-52 - 1.0; };
  for (const Shape& shape : shapes) {
    for (int trial = 0; trial < 20; ++trial) {
      const double friction = trial % 2 == 0 ? 0.3 : 100.0;
      Rig rig(rig_scene(shape, friction, trial % 4 < 2 ? 0.0 : 0.3), true);
      const double a[] = {random(), random(), random(), random(), random(), random()};
      constexpr int steps = 4000;  // a cycle
      double work = 0.0;
      double turned_over = 0.0;  // what went to and fro
      (void)rig.go(2e-5, 0.0);
      for (int cycle = 0; cycle < 5; ++cycle) {
        double of_cycle = 0.0;
        for (int step = 1; step <= steps; ++step) {
          const double t = 2.0 * std::numbers::pi * step / steps;
          const double overlap =
              2e-5 * (1.0 + 0.3 * (a[0] * std::sin(t) + a[1] * (1.0 - std::cos(t)) / 2.0 + a[2] * std::sin(2.0 * t)));
          const double aside = 1e-5 * (a[3] * std::sin(t) + a[4] * (1.0 - std::cos(t)) + a[5] * std::sin(3.0 * t));
          const double w = rig.go(overlap, aside);
          of_cycle += w;
          turned_over += std::abs(w);
        }
        work += of_cycle;
        EXPECT_LT(work, 1e-5 * turned_over) << "trial " << trial << ", cycle " << cycle;
        EXPECT_LT(of_cycle, 1e-5 * turned_over) << "trial " << trial << ", cycle " << cycle;
      }
    }
  }
}

// At constant overlap the spring and its slider are elastic and ideally plastic.
TEST(FrictionWithMemory, LoopOfCyclicShearIsTheFrictionWork) {
  constexpr double mu = 0.3, overlap = 2e-5, most = 3e-5;
  for (const Shape& shape : shapes) {
    Rig rig(rig_scene(shape, mu, 0.0), true);
    const double limit = mu * 4.0 / 3.0 * 1e8 / (1.0 - 0.0625) * std::sqrt(r * overlap) * overlap;
    const double k = 8.0 * 1e8 / (2.0 * 1.25 * 1.75) * std::sqrt(r * overlap);
    constexpr int steps = 40000;
    double loop = 0.0;
    for (int step = 0; step <= 2 * steps; ++step) {
      const double t = static_cast<double>(step % steps) / steps;
      const double aside = most * (t < 0.25 ? 4.0 * t : (t < 0.75 ? 2.0 - 4.0 * t : 4.0 * t - 4.0));
      const double work = rig.go(overlap, aside);
      if (step > steps) loop += work;
      if (step == steps / 8) {
        EXPECT_WITHIN(rig.pull(), -std::min(limit, k * aside));
      }
    }
    EXPECT_WITHIN(loop, -4.0 * limit * (most - limit / k));
  }
}

/// Four spheres, or in the plane three, piled up on a rough floor.
World pyramid(const Shape& shape, double rolling) {
  scene::Scene s = rough_scene(shape, 0.6, rolling);
  s.features.rotation = true;
  s.in.contact.damping_ratio = 0.3;
  s.force_quantum = 0x1p-46;
  s.in.jamming.gravity = gravity;
  s.time_step = 5e-5;
  World world(s);
  if (shape.dimension == 2) {
    world.add({0.1 - r, r, 0.0}, {}, r);
    world.add({0.1 + r, r, 0.0}, {}, r);
    world.add({0.1, r + std::sqrt(3.0) * r, 0.0}, {}, r);
    return world;
  }
  for (const double angle : {0.0, 2.0, 4.0}) {
    const double turn = angle * std::numbers::pi / 3.0, out = 2.0 * r / std::sqrt(3.0);
    world.add({0.1 + out * std::cos(turn), 0.1 + out * std::sin(turn), r}, {}, r);
  }
  world.add({0.1, 0.1, r + r * std::sqrt(8.0 / 3.0)}, {}, r);
  return world;
}

TEST(FrictionWithMemory, PyramidStandsForAMillionSteps) {
  for (const Shape& shape : shapes) {
    for (const double rolling : {0.0, 0.1}) {
      World world = pyramid(shape, rolling);
      const auto count = world.store().owned();
      world.run(5.0);
      std::vector<Vec3> before;
      for (LocalIndex i = 0; i < count; ++i) before.push_back(world.position(i));
      for (int step = 0; step < 1000000; ++step) world.step();
      double floor = 0.0;
      for (LocalIndex i = 0; i < count; ++i) {
        for (std::size_t a = 0; a < 3; ++a)
          EXPECT_NEAR(world.position(i)[a], before[static_cast<std::size_t>(i)][a], 1e-12 * r);
        const double overlap = std::max(0.0, r - world.up(i));
        floor += 4.0 / 3.0 * 1e8 / (1.0 - 0.0625) * std::sqrt(r * overlap) * overlap;
      }
      EXPECT_WITHIN(floor, count * mass(r) * gravity);
    }
  }
}

}  // namespace
}  // namespace packmpi
