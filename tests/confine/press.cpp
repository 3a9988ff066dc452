// A lid on columns of spheres whose state under it is known: heights by Hertz' law, stress, energy. The same bits on
// any number of ranks.
#include "confine/press.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "confine/outcome.hpp"
#include "confine/servo.hpp"
#include "input/read.hpp"
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

// A vessel, where a column stands in it, and the area of a lid at a height [m2]; of a plane one it is as deep as a
// particle.
struct Vessel {
  const char* name;
  const char* keys;
  Vec3 foot;
  double (*area)(double height);
};
constexpr double pi = std::numbers::pi;
const Vessel vessels[] = {
    {"cylinder", "diameter = 1.0", {0.5, 0.5, 0.0}, [](double) { return pi * 0.25; }},
    {"annulus", "diameter = 1.0\ninner_diameter = 0.2", {0.8, 0.5, 0.0}, [](double) { return pi * (0.25 - 0.01); }},
    {"frustum",
     "bottom_diameter = 0.8\ntop_diameter = 1.0",
     {0.5, 0.5, 0.0},
     [](double h) { return pi * std::pow(0.4 + 0.1 * h / 0.9, 2.0); }},
    {"sphere", "diameter = 1.0", {0.5, 0.5, 0.0}, [](double h) { return pi * h * (1.0 - h); }},
    {"prism", "polygon = [[0, 0], [1, 0], [0.5, 1]]", {0.5, 0.3, 0.0}, [](double) { return 0.5; }},
    {"circle",
     "dimension = 2\ndiameter = 1.0",
     {0.5, 0.0, 0.0},
     [](double h) { return 2.0 * r * 2.0 * std::sqrt(h * (1.0 - h)); }},
    {"trapezium",
     "dimension = 2\nbottom_width = 0.8\ntop_width = 1.0",
     {0.5, 0.0, 0.0},
     [](double h) { return 2.0 * r * (0.8 + 0.2 * h / 0.9); }},
};

input::Input in_vessel(const Vessel& vessel) {
  const std::string text = fmt::format(
      "[container]\nshape = \"{}\"\nheight = 0.9\n{}\n[particles]\ndensity = 1000\nyoungs_modulus = 1e8\n"
      "poisson_ratio = 0.25\nradius = {{ distribution = \"equal\", value = {} }}\n[layers]\nthickness = 0.2\n"
      "fraction = 0.2\n[contact]\nfriction = 0\n[jamming]\ngravity = {}\n[confinement]\nvertical = {}\ntolerance = "
      "1e-7\n",
      vessel.name, vessel.keys, r, gravity, stress);
  return input::parse(text, vessel.name, {});
}

// What the lid presses a column with is the stress over its own area there, whatever the vessel.
TEST(Press, ALidFitsEveryVessel) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const Vessel& vessel : vessels) {
    SCOPED_TRACE(vessel.name);
    Pressed pressed(comm, in_vessel(vessel), 0);
    const auto up = static_cast<std::size_t>(pressed.scene.container.vertical());
    for (int k = 0; k < 3; ++k) {
      Vec3 x = vessel.foot;
      x[up] = r + 2.0 * r * k;
      pressed.place(x);
    }
    pressed.bed.neighborhood.rebuild(pressed.bed.store);
    confine_bed(pressed.bed, pressed.nobody);
    const confine::Outcome got = pressed.outcome();
    const double each = stress * vessel.area(got.lid), w = weight();
    const double height = 6.0 * r - hertz(each, true) - hertz(each + w, false) - hertz(each + 2.0 * w, false) -
                          hertz(each + 3.0 * w, true);
    EXPECT_NEAR(got.lid, height, 1e-8);
    EXPECT_NEAR(got.on_lid, stress, 1e-5);
    EXPECT_LE(got.worst(), 1e-7);
  }
}

// Four spheres pressed into the wall of a cylinder: on its area up to the lid, and in the stress of the contacts.
TEST(Press, TheStressOnARoundWallIsTheMeanOverIt) {
  const comm::Comm comm(MPI_COMM_WORLD);
  Pressed pressed(comm, in_vessel(vessels[0]), 0);
  constexpr double deep = 1e-4;
  for (const auto& [x, y] : {std::array{1.0, 0.0}, {-1.0, 0.0}, {0.0, 1.0}, {0.0, -1.0}}) {
    pressed.place({0.5 + x * (0.5 - r + deep), 0.5 + y * (0.5 - r + deep), 0.2});
  }
  confine::State& now = pressed.bed.progress.confined;
  now = confine::begin(pressed.scene, 0.4);
  confine::apply(now, pressed.scene.container);
  pressed.bed.neighborhood.rebuild(pressed.bed.store);
  const double force = 4.0 / 3.0 * 1e8 / (1.0 - 0.0625) * std::sqrt(r) * std::pow(deep, 1.5);
  const confine::Outcome got = pressed.outcome();
  ASSERT_EQ(got.on_sides.size(), 2U);
  for (const double side : got.on_sides) EXPECT_NEAR(side, 4.0 * force / (2.0 * pi * 0.5 * 0.4), 1e-9 * force);
  const double volume = pi * 0.25 * 0.4;
  for (const int a : {0, 1}) EXPECT_NEAR(got.of_contacts.at(a), 2.0 * (r - deep) * force / volume, 1e-9 * force);
  EXPECT_EQ(got.on_lid, 0.0);
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

// What goes on from a checkpoint has sides that have moved, and moves them as before.
TEST(Press, SidesThatHaveMovedChangeNoGain) {
  const std::string text =
      "[container]\nsize = [0.04, 0.04, 0.04]\nboundary = [\"wall\", \"periodic\"]\n[particles]\nyoungs_modulus = 5e7\n"
      "poisson_ratio = 0.2\ndensity = 2650.0\ndiameter = { distribution = \"equal\", value = 0.006 }\n"
      "[layers]\nthickness = 0.02\nfraction = 0.22\n[jamming]\ngravity = 9.81\n[contact]\ntangential = \"mindlin\"\n"
      "friction = 0.3\n[confinement]\nvertical = 5e3\nlateral = 3e3\n[mixture]\nshare_by = \"number\"\n"
      "[[component]]\nname = \"a\"\nshare = 1\n[[component]]\nname = \"b\"\nshare = 1\ndensity = 1500.0\n";
  scene::Scene scene = scene::build(input::parse(text, "mixture.toml", {}));
  const confine::Gains before = confine::gains_of(scene, 0.05, 0.08);
  scene.container.size[0] *= 0.97, scene.container.size[1] *= 0.98;
  const confine::Gains after = confine::gains_of(scene, 0.05, 0.08);
  EXPECT_EQ(after.modulus, before.modulus);
  EXPECT_EQ(after.closing, before.closing);
  EXPECT_EQ(after.crossing, before.crossing);
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
