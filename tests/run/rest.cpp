// The measures of rest on beds whose values are known, who holds whom, and what is said where a limit is missed. The
// same bits on any number of ranks.
#include "observe/rest.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <numbers>

#include "report/judge.hpp"
#include "run/make_pack.hpp"
#include "support/packed.hpp"
#include "support/placed_bed.hpp"

namespace packmpi::run {
namespace {

using test::Bench;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double r = 0.05;
constexpr double gravity = 2.0;

double mass_of(double radius) { return 1000.0 * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius; }

observe::Rest rest_of(const Bench& bench) {
  const Bed& bed = bench.bed();
  return observe::rest(bed.comm, bed.store, bench.scene(), bed.neighborhood);
}

// Overlap [m] of a contact that bears `force`: of two particles, or with the rigid wall.
double hertz(double force, bool wall) {
  const double modulus = 1e8 / ((wall ? 1.0 : 2.0) * (1.0 - 0.0625));
  return std::pow(force / (4.0 / 3.0 * modulus * std::sqrt(wall ? r : 0.5 * r)), 2.0 / 3.0);
}

// Three in a column, each contact under the weight of what is above it.
struct Column {
  double weight = mass_of(r) * gravity;
  double floor = hertz(3.0 * weight, true), low = hertz(2.0 * weight, false), high = hertz(weight, false);

  void place(Bench& bench, double x, double speed = 0.0) const {
    double z = r - floor;
    for (const double gap : {2.0 * r - low, 2.0 * r - high, 0.0}) {
      bench.place({x, 0.5, z}, r, {speed, 0.0, 0.0});
      z += gap;
    }
  }
};

TEST(Rest, AColumnUnderItsWeight) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const Column column;
  Bench bench(comm, test::small_input(3, 1.0, r));
  column.place(bench, 0.3);
  column.place(bench, 0.7);
  bench.start();
  const observe::Rest rest = rest_of(bench);
  EXPECT_LT(rest.unbalanced_force, 1e-9);
  EXPECT_EQ(rest.kinetic_energy, 0.0);
  EXPECT_NEAR(rest.support, 1.0, 1e-9);
  EXPECT_NEAR(rest.mean_overlap, 0.5 * (column.low + column.high) / r, 1e-12);
  EXPECT_NEAR(rest.worst_overlap, column.low / r, 1e-12) << "a pair is softer than the floor";
  EXPECT_DOUBLE_EQ(rest.network.coordination, 4.0 / 3.0);
  EXPECT_EQ(rest.network.rattlers, 1.0) << "two contacts and the weight do not hold a sphere";
}

TEST(Rest, EnergyIsOverMGDAndSupportOverTheWeight) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const Column column;
  Bench bench(comm, test::small_input(3, 1.0, r));
  column.place(bench, 0.3, 0.1);
  bench.place({0.7, 0.5, 0.5}, r, {}, {0.0, 7.0, 0.0});  // falls, and spins
  bench.start();
  const observe::Rest rest = rest_of(bench);
  const double expected = (3.0 * 0.5 * 0.01 + 0.2 * r * r * 49.0) / (4.0 * gravity * 2.0 * r);
  EXPECT_NEAR(rest.kinetic_energy, expected, 1e-12 * expected);
  EXPECT_NEAR(rest.support, 3.0 / 4.0, 1e-9);
}

TEST(Rest, SupportIsWhatTheFluidLeavesToBear) {
  const comm::Comm comm(MPI_COMM_WORLD);
  input::Input in = test::small_input(3, 1.0, r);
  const double weight = mass_of(r) * gravity;
  in.drag.coefficient = 0.1;
  for (const double share : {0.5, 1.5}) {  // of the weight that the fluid lifts
    in.drag.fluid_velocity = {0.3, 0.0, share * weight / in.drag.coefficient};
    Bench bench(comm, in);
    bench.place({0.5, 0.5, r - hertz(0.5 * weight, true)}, r);
    bench.start();
    EXPECT_NEAR(rest_of(bench).support, share < 1.0 ? 1.0 : 0.0, 1e-9);
  }
}

TEST(Rest, SideWallsBearByFriction) {
  const comm::Comm comm(MPI_COMM_WORLD);
  Bench bench(comm, test::small_input(3, 1.0, r));
  const double weight = mass_of(r) * gravity;
  bench.place({r - hertz(weight, true), 0.5, 0.5}, r, {0.0, 0.0, -10.0});  // slides down the wall: 0.2 of its force
  bench.start();
  EXPECT_NEAR(rest_of(bench).support, 0.2, 1e-9);
}

// In the plane two contacts and the weight hold a disc: a top on two feet, and a column that comes apart from its top.
TEST(Rest, RattlersAreTakenAwayRoundByRound) {
  const comm::Comm comm(MPI_COMM_WORLD);
  Bench bench(comm, test::small_input(2, 1.0, r));
  const double touch = 1.999 * r, foot = 0.999 * r;
  bench.place({0.44, foot, 0.0}, r);
  bench.place({0.56, foot, 0.0}, r);
  bench.place({0.5, foot + std::sqrt(touch * touch - 0.0036), 0.0}, r);
  for (int k = 0; k < 3; ++k) bench.place({0.8, foot + k * touch, 0.0}, r);
  bench.start();
  const observe::Network network = rest_of(bench).network;
  EXPECT_DOUBLE_EQ(network.coordination, 8.0 / 6.0);
  EXPECT_DOUBLE_EQ(network.loose, 1.0 / 6.0);
  EXPECT_DOUBLE_EQ(network.rattlers, 3.0 / 6.0);
  EXPECT_DOUBLE_EQ(network.held_coordination, 4.0 / 3.0);
}

// A cube of 4^3 on the floor: its upper corners have three neighbours. With the weight that is enough; without, the
// whole cube comes apart from them.
TEST(Rest, TheWeightIsAForceToo) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const double g : {gravity, 0.0}) {
    input::Input in = test::small_input(3, 1.0, r);
    in.jamming.gravity = g;
    in.layers.velocity = {0.0, 0.0, -1.0};
    Bench bench(comm, in);
    for (int k = 0; k < 64; ++k) {
      bench.place({0.3 + 1.999 * r * (k % 4), 0.3 + 1.999 * r * (k / 4 % 4), r * (0.999 + 1.999 * (k / 16))}, r);
    }
    bench.start();
    const observe::Network network = rest_of(bench).network;
    EXPECT_DOUBLE_EQ(network.coordination, 2.0 * 144.0 / 64.0);
    EXPECT_DOUBLE_EQ(network.loose, g > 0.0 ? 0.0 : 4.0 / 64.0);
    EXPECT_DOUBLE_EQ(network.rattlers, g > 0.0 ? 0.0 : 1.0);
    EXPECT_DOUBLE_EQ(network.held_coordination, g > 0.0 ? 4.5 : 0.0);
  }
}

// A square pyramid: the top on four, these on nine, each of which stands on the floor.
TEST(Rest, NobodyRattlesInAPyramid) {
  const comm::Comm comm(MPI_COMM_WORLD);
  Bench bench(comm, test::small_input(3, 1.0, r));
  const double d = 1.999 * r;
  for (int layer = 0; layer < 3; ++layer) {
    const int side = 3 - layer;
    for (int k = 0; k < side * side; ++k) {
      bench.place({0.4 + d * (k % side + 0.5 * layer), 0.4 + d * (k / side + 0.5 * layer),
                   0.999 * r + d * layer / std::numbers::sqrt2},
                  r);
    }
  }
  bench.start();
  const observe::Network network = rest_of(bench).network;
  EXPECT_DOUBLE_EQ(network.coordination, 2.0 * (12.0 + 4.0 + 16.0 + 4.0) / 14.0);
  EXPECT_EQ(network.rattlers, 0.0);
  EXPECT_EQ(network.held_coordination, network.coordination);
}

TEST(Rest, TheSameBitsOnAnyRanks) {
  const comm::Comm world(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const auto rest = [](const comm::Comm& comm) {
    input::Input in = test::periodic(test::graded_input(3, 1.0, 0.03, 1.5));
    in.drag.coefficient = 0.01;
    Bench bench(comm, in);
    for (int k = 0; k < 300; ++k) {
      const double shift = 0.003 * std::sin(7.0 * k);
      bench.place({0.02 + 0.08 * (k % 12), 0.02 + 0.08 * (k / 12 % 5) + shift, 0.04 + 0.08 * (k / 60) + shift},
                  0.0415 + 0.001 * std::cos(3.0 * k), {shift, -shift, 2.0 * shift}, {1.0, 0.0, 3.0 * shift});
    }
    bench.start();
    return rest_of(bench);
  };
  const observe::Rest many = rest(world), one = rest(alone);
  EXPECT_EQ(many.unbalanced_force, one.unbalanced_force);
  EXPECT_EQ(many.kinetic_energy, one.kinetic_energy);
  EXPECT_EQ(many.support, one.support);
  EXPECT_EQ(many.mean_overlap, one.mean_overlap);
  EXPECT_EQ(many.worst_overlap, one.worst_overlap);
  EXPECT_EQ(many.network.coordination, one.network.coordination);
  EXPECT_EQ(many.network.rattlers, one.network.rattlers);
  EXPECT_EQ(many.network.held_coordination, one.network.held_coordination);
  EXPECT_GT(many.network.rattlers, 0.0);
  EXPECT_LT(many.network.rattlers, 1.0);
}

// --- what is said ---

input::Input judged_input() {
  input::Input in = test::small_input(3, 1.0, r);
  in.layers.duration = 2.0;
  in.contact.regularisation = input::Regularisation::shared;
  in.rest = {.unbalanced_force = 0.05,
             .kinetic_energy = 1e-4,
             .support = 0.02,
             .mean_overlap = 0.01,
             .worst_overlap = 0.05,
             .wait = 1.0};
  return in;
}

observe::Rest resting() {
  return {.unbalanced_force = 0.01,
          .kinetic_energy = 1e-5,
          .support = 0.99,
          .mean_overlap = 1e-3,
          .worst_overlap = 4e-3,
          .network = {}};
}

std::vector<std::string> missed(const input::Input& in, const observe::Rest& rest, double confined = 0.0) {
  const scene::Scene scene = scene::build(in);
  report::RunRecord record;
  record.confined.seconds = confined;
  record.reached = true;
  record.rest = rest;
  record.criteria = report::judge(scene, rest);
  return report::missed_targets(scene, record);
}

TEST(Judge, RestIsNothingMissed) {
  EXPECT_THAT(missed(judged_input(), resting()), IsEmpty());
  input::Input unasked = judged_input();
  unasked.rest = {};
  EXPECT_THAT(missed(unasked, {.unbalanced_force = HUGE_VAL, .kinetic_energy = 1.0, .support = 3.0, .network = {}}),
              IsEmpty());
  input::Input floating = judged_input();
  floating.jamming.gravity = 0.0;
  floating.layers.velocity = {0.0, 0.0, -1.0};
  EXPECT_THAT(missed(floating, {.unbalanced_force = 0.0, .kinetic_energy = 0.0, .support = 0.0, .network = {}}),
              IsEmpty());
}

TEST(Judge, EachMeasureIsNamedWithItsValueAndItsLimit) {
  observe::Rest rest = resting();
  rest.unbalanced_force = 0.4;
  EXPECT_THAT(missed(judged_input(), rest),
              ElementsAre(HasSubstr("rest.unbalanced_force: the unbalanced force ratio is 0.4, the limit is 0.05; ")));
  rest = resting();
  rest.kinetic_energy = 0.02;
  EXPECT_THAT(
      missed(judged_input(), rest),
      ElementsAre(HasSubstr("rest.kinetic_energy: the mean kinetic energy over m g d is 0.02, the limit is 0.0001; ")));
  for (const double support : {0.9, 1.1}) {
    rest = resting();
    rest.support = support;
    EXPECT_THAT(missed(judged_input(), rest), ElementsAre(HasSubstr("it is to be 1 within 0.02; ")));
  }
  rest.support = std::nan("");
  EXPECT_EQ(missed(judged_input(), rest).size(), 1U);
}

TEST(Judge, SoftParticlesAreToldTheModulusThatWouldDo) {
  observe::Rest rest = resting();
  rest.mean_overlap = 0.04;  // 4^1.5 = 8, and a tenth more
  EXPECT_THAT(missed(judged_input(), rest),
              ElementsAre(HasSubstr("use particles.youngs_modulus = 8.8e+08 Pa or more")));
}

TEST(Judge, TheCauseIsTheFirstThatIsSo) {
  observe::Rest rest = resting();
  rest.kinetic_energy = 1.0;
  const auto words = [&](const input::Input& in) { return missed(in, rest).at(0); };
  EXPECT_THAT(words(judged_input()), HasSubstr("raise rest.wait (now 1 s), layers.duration (2 s) or contact.damping"));
  EXPECT_THAT(missed(judged_input(), rest, 3.0).at(0),
              HasSubstr("raise confinement.wait (now 3 s) or contact.damping"));
  input::Input in = judged_input();
  in.contact.regularisation = input::Regularisation::stop;
  EXPECT_THAT(words(in), HasSubstr("friction 0.2 with contact.regularisation = \"stop\""));
  in.contact.friction = in.contact.wall_friction = 0.0;
  EXPECT_THAT(words(in), HasSubstr("raise rest.wait"));
  in = judged_input();
  in.layers.duration = 0.001;
  EXPECT_THAT(words(in), HasSubstr("a layer takes 0.707 s to come down, layers.duration is 0.001 s"));
  in.layers.velocity = {0.0, 0.0, 1.0};
  EXPECT_THAT(words(in), HasSubstr("thrown upward by layers.velocity"));
  in.drag.coefficient = 0.1;
  in.drag.fluid_velocity = {0.0, 0.0, 1.1 * mass_of(r) * gravity / 0.1};
  EXPECT_THAT(words(in), HasSubstr("the fluid lifts particles"));
}

TEST(Judge, HeightAndAuditAreTargetsToo) {
  const scene::Scene scene = scene::build(judged_input());
  report::RunRecord record;
  record.reached = false;
  record.stop_reason = "layers.maximum";
  record.height = 0.5;
  record.target_height = 1.0;
  record.audit = {
      .expected = 10, .found = 9, .non_finite = 1, .worst_overlap = 0.6, .worst_wall_penetration = 0.0, .outside = 2};
  EXPECT_THAT(report::missed_targets(scene, record),
              ElementsAre(HasSubstr("0.5 m of 1 m"), HasSubstr("9 of 10"), HasSubstr("1 particles are not finite"),
                          HasSubstr("2 particles are outside"), HasSubstr("0.6 of a radius")));
}

std::vector<report::LayerRow> layers_of(const std::vector<double>& energies) {
  std::vector<report::LayerRow> rows(energies.size());
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k].kinetic_per_mgd = energies[k];
  return rows;
}

TEST(Judge, AnEnergyThatGrowsFromLayerToLayerEndsTheRun) {
  const scene::Scene scene = scene::build(judged_input());
  EXPECT_NO_THROW(report::check_energy(scene, layers_of({1e-3, 2e-3, 1e-3, 0.1, 0.1})));         // too few layers
  EXPECT_NO_THROW(report::check_energy(scene, layers_of({1e-3, 2e-3, 1e-3, 0.1, 5e-3, 0.1})));   // one is quiet
  EXPECT_NO_THROW(report::check_energy(scene, layers_of({1e-2, 2e-2, 2.1e-2, 0.1, 0.1, 0.1})));  // less than five times
  EXPECT_NO_THROW(report::check_energy(scene, layers_of({1e-6, 1e-6, 1e-6, 9e-3, 9e-3, 9e-3})));  // nothing to speak of
  EXPECT_NO_THROW(report::check_energy(scene, layers_of({0, 0, 0, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1}), 3));  // taken over
  try {
    report::check_energy(scene, layers_of({1e-3, 2e-3, 1e-3, 5e-3, 0.02, 0.03, 0.04}));
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::numerical_failure);
    EXPECT_THAT(error.what(), HasSubstr("layer 7: the energy of the bed grows from layer to layer: 0.002 m g d at most "
                                        "after one of the first 3, 0.02 m g d at least after one of the last 3; "));
  }
}

// --- runs ---

// A coarse brick that fills in a second of machine time.
input::Input brick() {
  input::Input in = judged_input();
  in.name = "rest";
  in.container.size = {0.6, 0.6, 0.15};
  in.layers.thickness = 0.25;
  in.layers.fraction = 0.15;
  in.layers.duration = 0.5;
  in.dynamics.time_step = 4e-4;
  in.output.log_every = 0.1;
  in.rest.wait = 5.0;
  return in;
}

report::RunRecord pack(const input::Input& in) { return test::packed(in, "rest"); }

TEST(Rest, TheFinalStageGoesOnUntilTheBedIsAtRest) {
  const report::RunRecord record = pack(brick());
  EXPECT_THAT(record.missed, IsEmpty());
  EXPECT_TRUE(report::at_rest(record.criteria));
  EXPECT_GE(record.relaxations, 1);
  EXPECT_EQ(record.relaxation_steps % 125, 0) << "hundredths of the longest wait";
  EXPECT_LT(record.relaxation_steps, 12500 * record.relaxations);
  EXPECT_GE(record.height, record.target_height);
}

TEST(Rest, AndNoLongerThanItsBound) {
  input::Input in = brick();
  in.rest.wait = 0.1;
  in.rest.kinetic_energy = 1e-30;
  in.layers.maximum = 1;
  const report::RunRecord record = pack(in);
  EXPECT_EQ(record.relaxations, 1);
  EXPECT_EQ(record.relaxation_steps, 250);
  EXPECT_THAT(record.missed, Contains(HasSubstr("rest.kinetic_energy")));
}

// A column of 75 diameters, released all at once. Where the support is no measure nothing tells that it swings, and it
// does so for a fifth of 40 s or until its contacts have damped it.
TEST(Rest, AHighBedThatSwingsIsStopped) {
  input::Input in = brick();
  in.container.size = {0.35, 0.35, 3.5};
  in.container.boundary = {input::Boundary::periodic, input::Boundary::periodic};
  in.contact.tangential = input::Tangential::mindlin;
  in.dynamics.time_step = 2e-4;
  in.dynamics.window = 3;
  in.dynamics.relaxation = 0.1;
  in.dynamics.rotation = false;  // none rolls on
  in.rest.kinetic_energy = 1e-6;
  in.rest.wait = 6.0;
  const report::RunRecord stopped = pack(in);
  in.rest.support = 1e9;
  in.rest.wait = 40.0;
  const report::RunRecord swings = pack(in);
  EXPECT_THAT(stopped.missed, IsEmpty());
  EXPECT_LT(4 * stopped.relaxation_steps, swings.relaxation_steps);
  EXPECT_NEAR(stopped.phi_bulk, swings.phi_bulk, 0.002) << "the same bed";
}

// The support is off, too, while particles fall; to stop them then would only keep them in the air.
TEST(Rest, ParticlesThatFallAreNotStopped) {
  input::Input in = brick();
  in.layers.duration = 0.05;  // of 0.3 s that a layer falls
  in.rest.wait = 40.0;
  const report::RunRecord fell = pack(in);
  in.rest.support = 1e9;
  const report::RunRecord left_alone = pack(in);
  EXPECT_THAT(fell.missed, IsEmpty());
  EXPECT_GT(fell.relaxation_steps, 1000);
  EXPECT_EQ(fell.relaxation_steps, left_alone.relaxation_steps);
  EXPECT_EQ(fell.phi_bulk, left_alone.phi_bulk);
}

TEST(Rest, ABedAtRestHasNoFinalStage) {
  input::Input in = brick();
  in.layers.duration = 4.0;
  const report::RunRecord record = pack(in);
  EXPECT_THAT(record.missed, IsEmpty());
  EXPECT_EQ(record.relaxations, 0);
  EXPECT_EQ(record.height_before_relaxation, 0.0);
  in.rest = {};
  const report::RunRecord without = pack(in);
  EXPECT_EQ(without.kinetic_energy, record.kinetic_energy) << "looking changes nothing";
  EXPECT_EQ(without.phi_bulk, record.phi_bulk);
}

TEST(Rest, LayersThatDoNotComeDownAreNoPack) {
  input::Input in = brick();
  in.layers.duration = 0.002;
  in.rest.wait = 0.0;
  in.rest.kinetic_energy = 1e-30;
  const report::RunRecord record = pack(in);
  EXPECT_FALSE(record.missed.empty());
  EXPECT_THAT(record.missed.at(0), HasSubstr("layers.duration is 0.002 s"));
}

TEST(Rest, TheBulkIsThatOfTheBedThatIsThere) {
  input::Input in = brick();
  in.layers.maximum = 2;
  in.container.size.back() = 0.5;
  const report::RunRecord record = pack(in);
  EXPECT_LT(record.height, 0.25);
  EXPECT_DOUBLE_EQ(record.bulk.high, 0.8 * record.height);
  EXPECT_GT(record.phi_bulk, 0.45);
  EXPECT_LT(record.phi_bulk, 0.7);
}

}  // namespace
}  // namespace packmpi::run
