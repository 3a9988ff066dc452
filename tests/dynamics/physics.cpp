// The kernel against exact solutions (doc/theory.md), to 0.1 %: impacts, restitution, friction, rolling, columns, drag.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/tiny_world.hpp"

namespace packmpi {
namespace {

using support::plain_scene;
using support::World;

constexpr double permille = 1e-3;

#define EXPECT_WITHIN(value, exact) EXPECT_NEAR(value, exact, permille* std::abs(exact))

struct Shape {
  int dimension;
  bool rotation;
};
constexpr Shape shapes[] = {{2, false}, {2, true}, {3, false}, {3, true}};

scene::Scene scene_of(const Shape& shape, double radius) { return plain_scene(shape.dimension, radius); }

Vec3 vector(int dimension, double lateral, double up) {
  return dimension == 3 ? Vec3{lateral, 50.0, up} : Vec3{lateral, up, 0.0};
}
Vec3 speed(int dimension, double lateral, double up) {
  return dimension == 3 ? Vec3{lateral, 0.0, up} : Vec3{lateral, up, 0.0};
}

double mass_of(const scene::Scene& s, double r) {
  return s.in.particles.density * 4.0 / 3.0 * std::numbers::pi * r * r * r;
}

void set_material(scene::Scene& s, double modulus, double poisson, double density) {
  s.in.particles.youngs_modulus = modulus;
  s.in.particles.poisson_ratio = poisson;
  s.in.particles.density = density;
}

/// What a collision of the first particle with the second (or with the floor if there is none) was.
struct Impact {
  double force = 0.0, overlap = 0.0, duration = 0.0;
};

Impact collide(World& world) {
  Impact impact;
  const bool pair = world.store().owned() > 1;
  int quiet = 0;
  for (int step = 0; quiet < 10; ++step) {
    const double reach = pair ? world.store().radius(0) + world.store().radius(1) : world.store().radius(0);
    const double distance = pair ? std::abs(world.position(1)[0] - world.position(0)[0]) : world.up(0);
    const double overlap = reach - distance;
    impact.overlap = std::max(impact.overlap, overlap);
    if (overlap > 0.0) impact.duration += world.scene().time_step;
    if (overlap <= 0.0 && impact.duration > 0.0) ++quiet;
    impact.force = std::max(impact.force, world.step().max_force);
    if (step == 1000000) throw std::runtime_error("the particles never part");
  }
  return impact;
}

/// Two equal spheres that meet at +-v.
Impact head_on(const scene::Scene& s, double v, World* after = nullptr) {
  const double r = s.sizes.largest();
  World world(s);
  world.add(vector(s.container.dimension, 50.0 - r, 50.0), speed(s.container.dimension, v, 0.0));
  world.add(vector(s.container.dimension, 50.0 + r, 50.0), speed(s.container.dimension, -v, 0.0));
  const Impact impact = collide(world);
  if (after != nullptr) *after = std::move(world);
  return impact;
}

TEST(Physics, HertzImpactOfTwoGlassSpheres) {  // Chung & Ooi (2011), test 1
  for (const Shape& shape : shapes) {
    for (const bool graded : {false, true}) {
      scene::Scene s = scene_of(shape, 0.01);
      s.features.rotation = s.features.friction = shape.rotation;
      if (graded) support::make_graded(s, 0.005, 0.01);
      set_material(s, 48e9, 0.20, 2800.0);
      s.time_step = 4e-9;
      const Impact impact = head_on(s, 10.0);
      EXPECT_WITHIN(impact.force, 10697.0);
      EXPECT_WITHIN(impact.overlap, 274.11e-6);
      EXPECT_WITHIN(impact.duration, 40.34e-6);
    }
  }
}

TEST(Physics, HertzImpactOnARigidPlane) {  // Chung & Ooi (2011), test 2
  for (const Shape& shape : shapes) {
    for (const bool graded : {false, true}) {
      scene::Scene s = scene_of(shape, 0.1);
      s.features.rotation = s.features.friction = shape.rotation;
      if (graded) support::make_graded(s, 0.05, 0.1);
      set_material(s, 70e9, 0.30, 2699.0);
      s.time_step = 7e-8;
      World world(s);
      world.add(vector(shape.dimension, 50.0, 0.1), speed(shape.dimension, 0.0, -0.2));
      const Impact impact = collide(world);
      EXPECT_WITHIN(impact.force, 11370.0);
      EXPECT_WITHIN(impact.overlap, 49.717e-6);
      EXPECT_WITHIN(impact.duration, 731.7e-6);
    }
  }
}

TEST(Physics, HertzImpactOfUnequalSpheres) {
  scene::Scene s = plain_scene(3, 0.01);
  support::make_graded(s, 0.01, 0.03);
  s.time_step = 2e-7;
  World world(s);
  world.add({50.0, 50.0, 50.0}, {1.0, 0.0, 0.0}, 0.01);
  world.add({50.04, 50.0, 50.0}, {0.0, 0.0, 0.0}, 0.03);
  const Impact impact = collide(world);
  const double m1 = mass_of(s, 0.01);
  const double m2 = mass_of(s, 0.03);
  const double m = m1 * m2 / (m1 + m2);
  const double k = 4.0 / 3.0 * 1e8 / (2.0 * (1.0 - 0.0625)) * std::sqrt(0.0075);
  const double overlap = std::pow(5.0 * m / (4.0 * k), 0.4);
  EXPECT_WITHIN(impact.overlap, overlap);
  EXPECT_WITHIN(impact.force, k * std::pow(overlap, 1.5));
  EXPECT_WITHIN(impact.duration, 2.9433 * overlap);
  EXPECT_WITHIN(world.velocity(0)[0], (m1 - m2) / (m1 + m2));
  EXPECT_WITHIN(world.velocity(1)[0], 2.0 * m1 / (m1 + m2));
}

/// Restitution at impact speed v, in steps of a 4000th of the contact.
double restitution(scene::Scene s, double v, double damping) {
  s.in.contact.damping_ratio = damping;
  s.time_step = 5e-8 * std::pow(v, -0.2);
  World after(s);
  head_on(s, v, &after);
  return (after.velocity(1)[0] - after.velocity(0)[0]) / (2.0 * v);
}

TEST(Physics, RestitutionDoesNotDependOnSpeed) {
  for (const Shape& shape : shapes) {
    for (const bool cutoff : {false, true}) {
      scene::Scene s = scene_of(shape, 0.01);
      s.in.contact.tension_cutoff = cutoff;
      const double slow = restitution(s, 0.01, 0.2);
      EXPECT_WITHIN(restitution(s, 0.1, 0.2), slow);
      EXPECT_WITHIN(restitution(s, 1.0, 0.2), slow);
      s = scene_of(shape, 0.01);
      s.in.contact.tension_cutoff = cutoff;
      set_material(s, 3e8, 0.1, 700.0);
      EXPECT_WITHIN(restitution(s, 0.1, 0.2), slow);
    }
  }
}

TEST(Physics, RestitutionOfTheLiteralLawIsExact) {
  // With d = alpha sqrt(m* k) delta^(1/4) and contact until delta = 0, ln e = -pi b / sqrt(1 - b^2), b = alpha / sqrt 5
  // (Antypov & Elliott 2011); here alpha = 2 xi sqrt(3/2).
  for (const double xi : {0.02, 0.1, 0.3}) {
    scene::Scene s = plain_scene(3, 0.01);
    s.in.contact.tension_cutoff = false;
    const double b = xi * std::sqrt(6.0 / 5.0);
    EXPECT_WITHIN(restitution(s, 1.0, xi), std::exp(-std::numbers::pi * b / std::sqrt(1.0 - b * b))) << xi;
    s.in.contact.tension_cutoff = true;  // nothing pulls back while parting
    EXPECT_GT(restitution(s, 1.0, xi), std::exp(-std::numbers::pi * b / std::sqrt(1.0 - b * b))) << xi;
  }
}

scene::Scene rough_scene(const Shape& shape, double friction) {
  scene::Scene s = scene_of(shape, 0.01);
  s.features.rotation = shape.rotation;
  support::add_friction(s, friction);
  return s;
}

/// r omega of the first particle about the axis that rolling along +x turns it.
double rolling_speed(const World& world) {
  const Vec3 omega = world.store().spin(0);
  return world.scene().container.dimension == 3 ? omega[1] * world.store().radius(0)
                                                : -omega[2] * world.store().radius(0);
}

TEST(Physics, ObliqueImpactInGrossSlip) {  // Chung & Ooi (2011), tests 4 to 6
  constexpr double mu = 0.2;
  for (const Shape& shape : shapes) {
    for (const bool graded : {false, true}) {
      scene::Scene s = rough_scene(shape, mu);
      if (graded) support::make_graded(s, 0.005, 0.01);
      s.time_step = 1e-7;
      for (const double vt : {-3.0, 1.6, 4.0}) {  // beyond 7/2 mu (1 + e) = 1.4
        World world(s);
        world.add(vector(shape.dimension, 50.0, 0.01), speed(shape.dimension, vt, -1.0));
        collide(world);
        const double sign = std::copysign(1.0, vt);
        EXPECT_WITHIN(world.velocity(0)[0], vt - sign * mu * 2.0);
        if (shape.rotation) {
          EXPECT_WITHIN(rolling_speed(world), sign * 2.5 * mu * 2.0);
        }
      }
    }
  }
}

TEST(Physics, ObliqueImpactBelowGrossSlipEndsRolling) {
  for (const Shape& shape : shapes) {
    scene::Scene s = rough_scene(shape, 0.2);
    s.time_step = 1e-7;
    World world(s);
    world.add(vector(shape.dimension, 50.0, 0.01), speed(shape.dimension, 0.3, -1.0));
    collide(world);
    EXPECT_NEAR(world.velocity(0)[0], shape.rotation ? 5.0 / 7.0 * 0.3 : 0.0, permille * 0.3);
    if (shape.rotation) {
      EXPECT_WITHIN(rolling_speed(world), 5.0 / 7.0 * 0.3);
    }
  }
}

/// A sphere at rest on the floor under gravity, sliding along x.
World resting_sphere(scene::Scene s, double sliding) {
  s.in.jamming.gravity = 2.0;
  const double r = s.sizes.largest();
  const double k = 4.0 / 3.0 * 1e8 / (1.0 - 0.0625) * std::sqrt(r);
  World world(s);
  const double overlap = std::pow(mass_of(s, r) * 2.0 / k, 2.0 / 3.0);
  world.add(vector(s.container.dimension, 50.0, r - overlap), speed(s.container.dimension, sliding, 0.0));
  return world;
}

TEST(Physics, SlidingSphereStartsToRoll) {
  constexpr double mu = 0.2;
  constexpr double v0 = 0.4;
  constexpr double end = 2.0 * v0 / (7.0 * mu * 2.0);  // of slip
  for (const Shape& shape : {shapes[1], shapes[3]}) {
    scene::Scene s = rough_scene(shape, mu);
    s.in.contact.damping_ratio = 0.1;
    s.time_step = 2e-5;
    World world = resting_sphere(s, v0);
    world.run(0.5 * end);
    EXPECT_WITHIN(world.velocity(0)[0], v0 - mu * 2.0 * 0.5 * end);
    EXPECT_WITHIN(rolling_speed(world), 2.5 * mu * 2.0 * 0.5 * end);
    world.run(0.49 * end);
    EXPECT_GT(world.velocity(0)[0] - rolling_speed(world), 0.005 * v0);  // still slips
    world.run(0.02 * end);
    EXPECT_WITHIN(world.velocity(0)[0], 5.0 / 7.0 * v0);
    EXPECT_WITHIN(rolling_speed(world), 5.0 / 7.0 * v0);
    world.run(0.1);
    EXPECT_WITHIN(world.velocity(0)[0], 5.0 / 7.0 * v0);  // rolling has no resistance
  }
}

TEST(Physics, CentreVelocitiesDoNotFeelSpin) {  // the literal eq. (14): friction brakes the sphere to a stop
  for (const Shape& shape : {shapes[1], shapes[3]}) {
    scene::Scene s = rough_scene(shape, 0.2);
    s.in.contact.friction_velocity = input::FrictionVelocity::centre;
    World world = resting_sphere(s, 0.04);
    world.run(0.2);
    EXPECT_NEAR(world.velocity(0)[0], 0.0, 1e-9);
    EXPECT_WITHIN(rolling_speed(world), 2.5 * 0.04);
  }
}

TEST(Physics, RegularisationsOfSlip) {
  for (const Shape& shape : shapes) {
    scene::Scene s = rough_scene(shape, 1.0);
    const auto slip = [&](const World& world) {
      return world.velocity(0)[0] - (shape.rotation ? rolling_speed(world) : 0.0);
    };
    s.time_step = 1e-5;
    s.in.contact.regularisation = input::Regularisation::stop;
    World stop = resting_sphere(s, 1e-5);
    stop.step();
    EXPECT_NEAR(slip(stop), 0.0, 1e-11);  // gone within the step
    s.in.contact.regularisation = input::Regularisation::viscous;
    s.in.contact.slip_time = 0.02;
    World viscous = resting_sphere(s, 1e-4);
    viscous.run(0.02);
    EXPECT_WITHIN(slip(viscous), 1e-4 * std::exp(-1.0));
    s.in.contact.regularisation = input::Regularisation::none;
    World literal = resting_sphere(s, 1e-7);  // mu g dt is far more than stops it: an explicit step reverses the slip
    literal.step();
    EXPECT_LT(slip(literal), -1e-6);
  }
}

TEST(Physics, ColumnUnderGravity) {
  constexpr int n = 6;
  constexpr double r = 0.01;
  for (const Shape& shape : shapes) {
    scene::Scene s = rough_scene(shape, 0.2);
    s.in.contact.damping_ratio = 0.4;
    s.in.jamming.gravity = 2.0;
    s.time_step = 2e-5;
    World world(s);
    for (int i = 0; i < n; ++i) world.add(vector(shape.dimension, 50.0, r * (1.0 + 2.0 * i)), {});
    const dynamics::StepReport report = world.run(0.5);
    const double weight = mass_of(s, r) * 2.0;
    const double k = 4.0 / 3.0 * 1e8 / (2.0 * (1.0 - 0.0625)) * std::sqrt(0.5 * r);
    EXPECT_WITHIN(report.max_force, n * weight);  // on the floor
    EXPECT_LT(report.max_speed, 1e-7);
    for (int i = 0; i + 1 < n; ++i) {  // the contact above i carries all that is above
      const double overlap = 2.0 * r - (world.up(i + 1) - world.up(i));
      EXPECT_WITHIN(overlap, std::pow((n - 1 - i) * weight / k, 2.0 / 3.0));
    }
  }
}

TEST(Physics, FreeFallWithDrag) {
  for (const Shape& shape : shapes) {
    scene::Scene s = scene_of(shape, 0.01);
    s.features.rotation = s.features.friction = shape.rotation;
    s.features.drag = true;
    s.in.jamming.gravity = 2.0;
    s.in.drag.coefficient = 0.05;
    s.in.drag.fluid_velocity = speed(shape.dimension, 0.3, 0.1);
    s.time_step = 1e-5;
    const double rate = 0.05 / mass_of(s, 0.01);  // [1/s]
    World world(s);
    world.add(vector(shape.dimension, 50.0, 50.0), {});
    for (int piece = 1; piece <= 3; ++piece) {
      world.run(0.5 / rate);
      const double gone = 1.0 - std::exp(-0.5 * piece);
      EXPECT_WITHIN(world.velocity(0)[0], 0.3 * gone);
      EXPECT_WITHIN(world.velocity(0)[static_cast<std::size_t>(shape.dimension - 1)], (0.1 - 2.0 / rate) * gone);
    }
  }
}

TEST(Physics, CentreBeyondAWallIsPushedBack) {
  for (const Shape& shape : shapes) {
    scene::Scene s = scene_of(shape, 0.01);
    s.features.rotation = s.features.friction = shape.rotation;
    World world(s);
    world.add(vector(shape.dimension, 50.0, -0.002), {});
    const double force = 4.0 / 3.0 * 1e8 / (1.0 - 0.0625) * std::sqrt(0.01) * std::pow(0.012, 1.5);
    EXPECT_WITHIN(world.step().max_force, force);
    EXPECT_WITHIN(world.velocity(0)[static_cast<std::size_t>(shape.dimension - 1)],
                  force / mass_of(s, 0.01) * s.time_step);
  }
}

}  // namespace
}  // namespace packmpi
