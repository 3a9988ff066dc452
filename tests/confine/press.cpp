// A lid on columns of spheres whose state under it is known: heights by Hertz' law, stress, energy. The same bits on
// any number of ranks.
#include "confine/press.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "confine/outcome.hpp"
#include "confine/servo.hpp"
#include "observe/measure.hpp"
#include "run/confine.hpp"
#include "support/scenes.hpp"

namespace packmpi::run {
namespace {

constexpr double r = 0.05, gravity = 2.0, stress = 100.0;  // [m], [m/s2], [Pa] on 1 m2

double weight() { return 1000.0 * 4.0 / 3.0 * std::numbers::pi * r * r * r * gravity; }

// Overlap [m] of a contact that bears `force`: of two particles, or with the rigid wall.
double hertz(double force, bool wall) {
  const double modulus = 1e8 / ((wall ? 1.0 : 2.0) * (1.0 - 0.0625));
  return std::pow(force / (4.0 / 3.0 * modulus * std::sqrt(wall ? r : 0.5 * r)), 2.0 / 3.0);
}

input::Input under_lid(double tolerance) {
  input::Input in = test::small_input(3, 1.0, r);
  in.contact.friction = in.contact.wall_friction = 0.0;
  in.confinement.emplace();
  in.confinement->vertical = stress;
  in.confinement->tolerance = tolerance;
  return in;
}

// Columns of three, touching, at rest but for their overlaps.
struct Pressed {
  Pressed(const comm::Comm& comm, const input::Input& in, int columns) : scene(scene::build(in)), bed(comm, scene) {
    bed.box = &scene.container;
    for (int c = 0; c < columns; ++c) {
      const double x = (c + 0.5) / columns;
      for (int k = 0; k < 3; ++k) place({x, 0.5, r + 2.0 * r * k});
    }
    bed.neighborhood.rebuild(bed.store);
    bed.progress.energy_given = energy();
  }
  void place(const Vec3& x) {
    if (bed.ownership.owner(bed.ownership.grid().column(x)) == bed.comm.rank()) {
      bed.store.add(bed.progress.count, x, r, {}, {});
    }
    ++bed.progress.count;
  }
  [[nodiscard]] double energy() const {
    const observe::Ledger now = observe::ledger(bed.comm, bed.store, scene, bed.stepper.law(), bed.neighborhood);
    return now.kinetic_energy + now.potential_energy + now.elastic_energy;
  }
  [[nodiscard]] confine::Outcome outcome() const {
    return confine::measure(bed.comm, bed.store, scene, bed.neighborhood, bed.progress.confined);
  }

  scene::Scene scene;
  Bed bed;
  Attendant nobody;
};

TEST(Press, AColumnUnderTheLidIsAsHighAsHertzSays) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const int columns : {1, 4}) {
    Pressed pressed(comm, under_lid(1e-7), columns);
    confine_bed(pressed.bed, pressed.nobody);
    const double each = stress / columns, w = weight();
    const double height = 6.0 * r - hertz(each, true) - hertz(each + w, false) - hertz(each + 2.0 * w, false) -
                          hertz(each + 3.0 * w, true);
    const confine::Outcome got = pressed.outcome();
    EXPECT_NEAR(got.lid, height, 1e-9);
    EXPECT_NEAR(got.on_lid, stress, 1e-5);
    EXPECT_NEAR(got.on_floor, stress + 3.0 * w * columns, 1e-3);
    EXPECT_LE(got.worst(), 1e-7);
    // All contacts are vertical: what they bear is what the lid presses with and half of the weight, about.
    EXPECT_NEAR(got.of_contacts[2], stress + 1.5 * w * columns, 0.01 * w * columns);
    EXPECT_EQ(got.of_contacts[0], 0.0);
    EXPECT_EQ(got.ratio, 0.0);
    EXPECT_TRUE(pressed.bed.progress.confined.over);
    EXPECT_LT(got.seconds, 60.0);
  }
}

// Nothing but the lid takes or gives energy: its work is what the particles have more of.
TEST(Press, WithoutDampingTheWorkOfTheLidIsTheEnergyOfTheBed) {
  const comm::Comm comm(MPI_COMM_WORLD);
  input::Input in = under_lid(1e-3);
  in.contact.damping_ratio = 0.0;
  in.confinement->wait = 0.02;
  Pressed pressed(comm, in, 2);
  const double before = pressed.energy();
  confine_bed(pressed.bed, pressed.nobody);
  const double gain = pressed.energy() - before, work = pressed.bed.progress.confined.work;
  EXPECT_GT(work, 1e-4);
  EXPECT_NEAR(gain, work, 0.02 * work);
  EXPECT_NEAR(pressed.bed.progress.energy_given, before + work, 1e-12);
}

// How long waves take counts where they are sent: through the height by a lid, and through the sides if those move.
TEST(Press, ALidAloneDoesNotWaitForTheFloorsWidth) {
  constexpr double height = 0.3, mass = 100.0;
  const auto crossing = [](double width, bool sides) {
    input::Input in = under_lid(1e-2);
    if (sides) in.confinement->lateral = stress;
    in.container.size[0] = width;
    return confine::gains_of(scene::build(in), height, width * mass).crossing;
  };
  EXPECT_GT(crossing(1.0, false), 0.0);
  EXPECT_EQ(crossing(8.0, false), crossing(1.0, false));
  EXPECT_NEAR(crossing(8.0, true) / crossing(1.0, true), 8.0, 1e-9);
  EXPECT_GT(crossing(1.0, true), 2.0 * crossing(1.0, false));
}

// The time is up before the stress is there: the run goes on to its end, and what is missing is said.
TEST(Press, GivesUpWhenTheTimeIsUp) {
  const comm::Comm comm(MPI_COMM_WORLD);
  input::Input in = under_lid(1e-3);
  in.confinement->wait = 1e-3;
  Pressed pressed(comm, in, 1);
  confine_bed(pressed.bed, pressed.nobody);
  EXPECT_TRUE(pressed.bed.progress.confined.over);
  EXPECT_GT(pressed.outcome().worst(), 1e-3);
}

TEST(Press, TheServoIsHeldBackByTheImpedanceOfTheBed) {
  const confine::Gains gains{.modulus = 1e7, .density = 1600.0, .impedance = 1.2e5, .closing = 0.05};
  double v = 0.0;
  for (int k = 0; k < 10000; ++k) v = confine::next_speed(gains, 16.0, v, -1200.0, 1e-5);
  EXPECT_NEAR(v, -1200.0 / 1.2e5, 1e-9);
  EXPECT_EQ(confine::next_speed(gains, 16.0, 0.0, -1e9, 1e-5), -0.05);
  EXPECT_EQ(confine::next_speed(gains, 16.0, 0.0, 0.0, 1e-5), 0.0);
}

}  // namespace
}  // namespace packmpi::run
