// The parts of a run: when a layer ends, what the final stage does, and what is written of them.
#include "run/settle.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "run/make_pack.hpp"
#include "support/packed.hpp"
#include "support/scenes.hpp"

namespace packmpi::run {
namespace {

// A coarse brick that fills in a few seconds of machine time.
input::Input brick() {
  input::Input in = test::small_input(3, 0.4, 0.02);
  in.name = "settle";
  in.container.size = {0.4, 0.4, 0.3};
  in.layers.thickness = 0.12;
  in.layers.fraction = 0.22;
  in.layers.duration = 0.8;
  in.layers.maximum = 4;
  in.drag.coefficient = 0.005;
  in.dynamics.time_step = 2e-4;
  in.output.log_every = 0.05;
  return in;
}

report::RunRecord pack(const input::Input& in) { return test::packed(in, "settle"); }

void expect_valid(const report::RunRecord& record) {
  EXPECT_EQ(record.audit.found, record.audit.expected);
  EXPECT_EQ(record.audit.outside, 0);
  EXPECT_EQ(record.audit.non_finite, 0);
  EXPECT_LT(record.audit.worst_overlap, 0.02);
  EXPECT_NEAR(record.floor_force, record.weight, 0.1 * record.weight);
}

TEST(Settle, HardeningRisesInEqualRatiosToTheHardModulus) {
  EXPECT_EQ(hardening(1e8, 1e8), std::vector<double>{1e8});
  const std::vector<double> moduli = hardening(1e7, 1e8);
  ASSERT_EQ(moduli.size(), 65U);
  EXPECT_EQ(moduli.front(), 1e7);
  EXPECT_EQ(moduli.back(), 1e8);
  for (std::size_t k = 1; k < moduli.size(); ++k) {
    EXPECT_NEAR(moduli[k] / moduli[k - 1], std::pow(10.0, 1.0 / 64.0), 1e-12);
  }
}

TEST(Settle, WindowMovesOnlyTheNewestLayersAndTheRelaxationAll) {
  input::Input in = brick();
  in.dynamics.window = 1;
  in.dynamics.relaxation = 0.4;
  const report::RunRecord record = pack(in);
  expect_valid(record);
  std::int64_t expected = 0;
  for (const report::LayerRow& row : record.layers) {
    EXPECT_EQ(row.steps, 4000);
    expected += row.steps * row.inserted;
  }
  EXPECT_EQ(record.relaxations, 1);
  EXPECT_EQ(record.relaxation_steps, 2000);
  EXPECT_EQ(record.particle_steps, expected + record.relaxation_steps * record.particles);
  EXPECT_LT(record.height, record.height_before_relaxation + 1e-3);
}

// A bed of which three layers stand at H_d before the final relaxation and below it afterwards: by `missed` of what
// they sink.
report::RunRecord pack_that_sinks(double duration, double missed) {
  input::Input in = brick();
  in.layers.duration = duration;  // short: much is left to the final relaxation
  in.layers.maximum = 3;
  in.dynamics.window = 1;
  in.dynamics.relaxation = 0.8;
  const report::RunRecord three = pack(in);
  EXPECT_LT(three.height, three.height_before_relaxation - 1e-3);
  in.container.size.back() = three.height + missed * (three.height_before_relaxation - three.height);
  in.layers.maximum = 0;
  return pack(in);
}

TEST(Settle, AnotherLayerFollowsAtOnceIfThePileIsGoingToSinkBelowTheHeight) {
  const report::RunRecord record = pack_that_sinks(0.4, 0.5);
  EXPECT_EQ(record.layers.size(), 4U);
  EXPECT_GT(record.layers[2].height, record.target_height);
  EXPECT_EQ(record.relaxations, 1);
  EXPECT_EQ(record.relaxation_steps, 4000);
  EXPECT_TRUE(record.reached);
  EXPECT_EQ(record.stop_reason, "height");
  expect_valid(record);
}

TEST(Settle, MoreLayersFollowIfTheBedSinksInTheRelaxationByMoreThanWasForeseen) {
  const report::RunRecord record = pack_that_sinks(0.1, 0.02);
  EXPECT_EQ(record.layers.size(), 4U);
  EXPECT_GE(record.relaxations, 2);
  EXPECT_EQ(record.relaxation_steps, 4000 * record.relaxations);
  EXPECT_TRUE(record.reached);
  EXPECT_EQ(record.stop_reason, "height");
  expect_valid(record);
}

// Layers of a bed whose third one stands above H_d by `share` of its rise before a short final stage.
std::size_t layers_if_above(double share, bool rotation, double friction) {
  input::Input in = brick();
  in.layers.duration = 0.4;
  in.dynamics.rotation = rotation;
  in.contact.friction = in.contact.wall_friction = friction;
  in.dynamics.relaxation = 0.05;
  in.layers.maximum = 3;
  const double rise = in.layers.thickness * in.layers.fraction / 0.58;
  in.container.size.back() = pack(in).height_before_relaxation - share * rise;
  in.layers.maximum = 0;
  const report::RunRecord record = pack(in);
  EXPECT_EQ(record.relaxations, 1);
  return record.layers.size();
}

TEST(Settle, RoughParticlesWithoutSpinAreExpectedToSinkFarther) {
  EXPECT_EQ(layers_if_above(0.3, true, 0.4), 4U);
  EXPECT_EQ(layers_if_above(0.7, true, 0.4), 3U);
  EXPECT_EQ(layers_if_above(0.4, false, 0.2), 4U);
  EXPECT_EQ(layers_if_above(0.8, false, 0.2), 3U);
  EXPECT_EQ(layers_if_above(0.8, false, 0.4), 4U);
}

TEST(Settle, AWindowOfAllLayersIsNoWindow) {
  input::Input in = brick();
  in.dynamics.relaxation = 0.1;
  const report::RunRecord all = pack(in);
  in.dynamics.window = 4;
  const report::RunRecord window = pack(in);
  EXPECT_EQ(window.particle_steps, all.particle_steps);
  EXPECT_EQ(window.height, all.height);
  EXPECT_EQ(window.phi_bulk, all.phi_bulk);
  EXPECT_EQ(window.kinetic_energy, all.kinetic_energy);
}

TEST(Settle, StopsALayerOnceItIsCalm) {
  input::Input in = brick();
  in.layers.duration = 3.0;
  in.layers.maximum = 2;
  in.dynamics.stop = input::StopRule::settled;
  in.dynamics.settled_energy = 1e-2;
  in.dynamics.settled_drift = 1e-2;
  in.dynamics.settled_hold = 0.05;
  in.dynamics.settled_force = 1.0;
  const report::RunRecord record = pack(in);
  for (const report::LayerRow& row : record.layers) {
    EXPECT_EQ(row.stop_reason, "settled");
    EXPECT_LT(row.duration, 1.5);
    EXPECT_GT(row.duration, 0.3);  // it takes that long to fall
    EXPECT_LT(row.kinetic_per_mgd, 1e-2);
    EXPECT_EQ(row.steps % 25, 0);  // looks every 5 ms
  }
  in.layers.duration = 0.4;
  for (double input::Dynamics::*limit : {&input::Dynamics::settled_energy, &input::Dynamics::settled_force}) {
    input::Input never = in;
    never.dynamics.*limit = 1e-30;
    for (const report::LayerRow& row : pack(never).layers) {
      EXPECT_EQ(row.stop_reason, "duration");
      EXPECT_EQ(row.steps, 2000);
    }
  }
}

TEST(Settle, SoftLayersEndAsHardAsTheOthers) {
  input::Input in = brick();
  in.layers.maximum = 3;
  in.layers.duration = 1.5;  // at rest, or impacts of the last to fall set the largest overlap
  in.dynamics.relaxation = 0.6;
  const report::RunRecord hard = pack(in);
  in.layers.youngs_modulus = 1e7;
  in.layers.time_step = 5e-4;
  const report::RunRecord soft = pack(in);
  expect_valid(soft);
  EXPECT_GT(soft.layers.back().max_overlap, 2.0 * hard.layers.back().max_overlap);  // (E ratio)^(2/3) is 4.6
  EXPECT_NEAR(soft.rest.mean_overlap, hard.rest.mean_overlap, 0.25 * hard.rest.mean_overlap);
  EXPECT_EQ(soft.layers.front().steps, 3000);
  EXPECT_EQ(soft.time_step, 2e-4);
  EXPECT_NEAR(soft.duration, 3 * 1.5 + 0.6, 1e-9);
}

}  // namespace
}  // namespace packmpi::run
