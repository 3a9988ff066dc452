// A density to order: the same bits on any number of ranks, after a stop, and refusals before anything is written.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "dynamics/law.hpp"
#include "input/read.hpp"
#include "pack/pack.hpp"
#include "report/judge.hpp"
#include "run/fill.hpp"
#include "run/make_pack.hpp"
#include "run/record.hpp"
#include "run/search.hpp"
#include "scene/mixture.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;

const std::string scene_text =
    "[container]\nsize = [0.12, 0.1, 0.1]\nboundary = [\"periodic\", \"periodic\"]\n"
    "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e7\npoisson_ratio = 0.25\n"
    "radius = { distribution = \"equal\", value = 0.01 }\n"
    "[layers]\nthickness = 0.1\nfraction = 0.25\nduration = 0.15\n[jamming]\ngravity = 9.81\n[drag]\ncoefficient = "
    "0.137\n"
    "[contact]\ntangential = \"mindlin\"\nfriction = 0.5\n[dynamics]\ntime_step = 1e-4\nrelaxation = 0.15\n"
    "[rest]\nwait = 0\nunbalanced_force = 1e9\nkinetic_energy = 1e9\nsupport = 1e9\n[output]\nlog_every = 0.1\n"
    "[target]\nsolid_fraction = 0.58\ntolerance = 0.03\n";

class Target : public ::testing::Test {
 protected:
  const comm::Comm comm_{MPI_COMM_WORLD};
  const fs::path folder_ = fs::path(testing::TempDir()) / ("packmpi_target_" + std::to_string(::getppid()));
  std::vector<std::string> changes_;

  void SetUp() override {
    if (comm_.rank() == 0) fs::remove_all(folder_);
    comm_.barrier();
  }
  [[nodiscard]] scene::Scene scene() const { return scene::build(input::parse(scene_text, "box.toml", {changes_})); }
  [[nodiscard]] Options options(const std::string& where, std::int64_t max_steps = 0) const {
    Options o;
    o.folder = (folder_ / where).string();
    o.verbosity = log::Verbosity::quiet;
    o.max_steps = max_steps;
    return o;
  }
  [[nodiscard]] pack::PackRows pack(const std::string& where) const {
    comm_.barrier();
    return pack::read_pack((folder_ / where / "box.hdf").string());
  }
};

void expect_same(const pack::PackRows& a, const pack::PackRows& b) {
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.radius, b.radius);
}

TEST_F(Target, IsMetWithTheSameBitsOnAnyNumberOfRanksAndAfterAStop) {
  const report::RunRecord record = make_pack(comm_, scene(), options("whole"));
  EXPECT_TRUE(record.targets_met) << report::missed_words(record, "; ");
  EXPECT_NEAR(record.phi_bulk, 0.58, 0.03);
  EXPECT_EQ(record.density.key, "target.solid_fraction");
  ASSERT_EQ(record.density.friction.size(), record.layers.size());
  EXPECT_GT(record.density.friction.front(), input::least_filling_friction);
  if (comm_.rank() == 0) {
    (void)make_pack(comm::Comm(MPI_COMM_SELF), scene(), options("alone"));
  }
  expect_same(pack("whole"), pack("alone"));
}

// A curve that is given, so that every layer that is measured turns the knob.
control::Filling some_filling() {
  control::Filling filling = control::curve_of({{0.0, 0.64, 0.64, 6.0}, {1.0, 0.57, 0.57, 4.5}});
  filling.on = true;
  filling.target = 0.6;
  filling.knob = control::knob_for(filling, filling.target);
  return filling;
}

control::Filling filled_on(const comm::Comm& comm, const scene::Scene& scene) {
  Bed bed(comm, scene);
  bed.progress.filling = some_filling();
  Attendant nobody;
  fill(bed, nobody);
  return bed.progress.filling;
}

TEST_F(Target, LayersTurnTheKnobAlikeOnAnyNumberOfRanks) {
  changes_ = {"container.size=[0.12, 0.1, 0.3]", "layers.duration=0.05", "dynamics.window=2"};
  const scene::Scene tall = scene();
  const control::Filling here = filled_on(comm_, tall);
  const control::Filling alone = filled_on(comm::Comm(MPI_COMM_SELF), tall);
  EXPECT_EQ(here.layer_knobs, alone.layer_knobs);
  EXPECT_EQ(here.layer_surfaces, alone.layer_surfaces);
  EXPECT_EQ(here.layer_fractions, alone.layer_fractions);
  EXPECT_NE(here.layer_knobs.back(), here.layer_knobs.front());
}

TEST_F(Target, StopsAndGoesOnToTheSameBits) {
  (void)make_pack(comm_, scene(), options("through"));
  for (const std::int64_t steps : {100, 700}) {
    const std::string where = "stopped_" + std::to_string(steps);
    EXPECT_THROW((void)make_pack(comm_, scene(), options(where, steps)), Error);
    Options on = options(where);
    on.restart = "auto";
    const report::RunRecord record = make_pack(comm_, scene(), on);
    EXPECT_EQ(record.density.key, "target.solid_fraction");
    expect_same(pack("through"), pack(where));
  }
}

// Two materials in place of the one, with friction of their own and of their pair.
std::string of_components() {
  std::string text = scene_text;
  const std::size_t begin = text.find("[particles]"), end = text.find("[layers]");
  text.erase(begin, end - begin);
  const std::string of = "youngs_modulus = 1e7\npoisson_ratio = 0.25\nradius = { distribution = \"equal\", value = ";
  return text +
         "[mixture]\nshare_by = \"volume\"\n[[component]]\nname = \"a\"\nshare = 2\ndensity = 1000\nfriction = 0.3\n" +
         of +
         "0.01 }\n[[component]]\nname = \"b\"\nshare = 1\ndensity = 2000\nwall_friction = 0.1\nrolling_friction = "
         "0.05\n" +
         of + "0.008 }\n[[pair]]\ncomponents = [\"a\", \"b\"]\nfriction = 0.2\n";
}

// All coefficients by one factor; and what the stage has of rolling beyond [contact]'s part is added.
TEST_F(Target, ComponentsAreFilledInWithTheirOwnFrictionInProportion) {
  const scene::Scene mixed = scene::build(input::parse(of_components(), "box.toml", {}));
  const scene::Friction own = scene::own_friction(mixed.in.contact);
  ASSERT_EQ(own.particles, 0.5);
  scene::Stage stage = mixed.settling;
  const dynamics::Law law = dynamics::make_law(mixed, stage);
  stage.friction = scene::Friction{0.1, 0.1, 0.02, 0.0};
  const dynamics::Law filling = dynamics::make_law(mixed, stage);
  const auto pair = [](const dynamics::Law& of, int a, int b) {
    return of.pair_table[static_cast<std::size_t>(scene::code_of(a) + scene::code_of(b))];
  };
  const auto wall = [](const dynamics::Law& of, int a) {
    return of.wall_table[static_cast<std::size_t>(scene::code_of(a))];
  };
  EXPECT_EQ(pair(law, 0, 0).friction, 0.3);
  EXPECT_EQ(pair(law, 0, 1).friction, 0.2);
  EXPECT_DOUBLE_EQ(pair(filling, 0, 0).friction, 0.06);
  EXPECT_DOUBLE_EQ(pair(filling, 0, 1).friction, 0.04);
  EXPECT_DOUBLE_EQ(pair(filling, 1, 1).friction, 0.1);
  EXPECT_DOUBLE_EQ(wall(filling, 1).friction, 0.02);
  EXPECT_DOUBLE_EQ(wall(filling, 0).friction, 0.2 * wall(law, 0).friction);
  EXPECT_DOUBLE_EQ(pair(filling, 1, 1).rolling_friction, 0.2 * 0.05 + 0.02);
}

TEST_F(Target, OfComponentsIsMetWithTheSameBitsAndAfterAStop) {
  const scene::Scene mixed = scene::build(input::parse(of_components(), "box.toml", {}));
  const report::RunRecord record = make_pack(comm_, mixed, options("mixed"));
  EXPECT_TRUE(record.targets_met) << report::missed_words(record, "; ");
  EXPECT_NEAR(record.phi_bulk, 0.58, 0.03);
  EXPECT_THROW((void)make_pack(comm_, mixed, options("mixed_stopped", 500)), Error);
  Options on = options("mixed_stopped");
  on.restart = "auto";
  (void)make_pack(comm_, mixed, on);
  expect_same(pack("mixed"), pack("mixed_stopped"));
  if (comm_.rank() == 0) (void)make_pack(comm::Comm(MPI_COMM_SELF), mixed, options("mixed_alone"));
  expect_same(pack("mixed"), pack("mixed_alone"));
}

// A density under stress: what is judged, and what samples are tried for; the same bits after a stop under the lid.
TEST_F(Target, UnderItsStressIsMetThereAndNotBefore) {
  changes_ = {"target.state=\"confined\"",       "target.solid_fraction=0.63", "target.tolerance=0.004",
              "confinement.vertical=\"20 kPa\"", "rest.mean_overlap=0.05",     "rest.worst_overlap=0.3"};
  const report::RunRecord record = make_pack(comm_, scene(), options("under"));
  EXPECT_NEAR(record.phi_bulk, 0.63, 0.004) << report::missed_words(record, "; ");
  EXPECT_LT(record.confined.phi_before, record.phi_bulk - 0.01);
  for (const std::string& missed : record.missed) EXPECT_EQ(missed.find("target."), std::string::npos) << missed;
  Options stopped = options("stopped", record.steps - 50);
  EXPECT_THROW((void)make_pack(comm_, scene(), stopped), Error);
  stopped.max_steps = 0;
  stopped.restart = "auto";
  (void)make_pack(comm_, scene(), stopped);
  expect_same(pack("under"), pack("stopped"));
  if (comm_.rank() == 0) (void)make_pack(comm::Comm(MPI_COMM_SELF), scene(), options("alone"));
  expect_same(pack("under"), pack("alone"));
}

// The stress presses a sample and a bed alike, so that what is left to foresee is the weight.
TEST_F(Target, ForeseesWhatAStressAddsToTheDensity) {
  changes_ = {"container.size=[0.5, 0.5, 0.5]", "confinement.vertical=\"20 kPa\"", "rest.mean_overlap=0.05"};
  const control::Squeeze before = control::squeeze_of(scene(), 0.0, {});
  changes_.emplace_back("target.state=\"confined\"");
  const control::Squeeze under = control::squeeze_of(scene(), 0.0, {});
  EXPECT_GT(under.ordered, 5.0 * before.ordered);
  // Overlaps go with (stress + weight)^(2/3): what the sample tells of both gives the bed's.
  const double weight = std::pow(before.ordered, 1.5), stress = std::pow(under.ordered, 1.5) - weight;
  EXPECT_NEAR(under.next, std::pow(stress + std::pow(before.next, 1.5), 2.0 / 3.0), 1e-12);
}

// What is measured of a bed no higher than the sample is measured of the sample as deep below the surface; higher up
// the bed presses more.
TEST_F(Target, ASlabIsHeldAgainstTheSamplesAsDeep) {
  changes_ = {"container.size=[0.5, 0.5, 0.5]", "container.boundary=[\"periodic\", \"periodic\"]"};
  const scene::Scene bed = scene();
  const double d = 2.0 * bed.sizes.mean(), height = control::sample_of(bed).scene.container.height();
  ASSERT_LT(height, 0.45);
  const control::Squeeze low = control::squeeze_of(bed, 0.9 * height, control::buried(0.9 * height, d));
  EXPECT_GT(low.now, 0.0);
  EXPECT_EQ(low.now, low.sample);
  const control::Squeeze high = control::squeeze_of(bed, 0.45, control::buried(0.45, d));
  EXPECT_GT(high.now, high.sample);
  EXPECT_EQ(high.sample, control::squeeze_of(bed, height, control::buried(height, d)).sample);
}

TEST_F(Target, WhatCannotBeIsRefusedWithBothLimitsBeforeAnythingIsWritten) {
  changes_ = {"target.solid_fraction=0.72"};
  try {
    (void)make_pack(comm_, scene(), options("never"));
    ADD_FAILURE() << "made";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    const std::string words = error.what();
    for (const char* part : {"target.solid_fraction", "0.7200", "porosity 0.2800", "out of what this scene can have"}) {
      EXPECT_NE(words.find(part), std::string::npos) << words;
    }
  }
  EXPECT_FALSE(fs::exists(folder_ / "never" / "box.log"));
}

TEST_F(Target, MissedIsSaidByName) {
  report::RunRecord record = targets_of(comm_, scene());
  record.reached = true;
  record.phi_bulk = 0.61;
  record.density.key = "target.porosity";
  record.density.fraction = 0.6;
  record.density.tolerance = 0.002;
  record.missed = report::missed_targets(scene(), record);
  EXPECT_NE(report::missed_words(record, "; ").find("target.porosity: the bulk has"), std::string::npos);
}

TEST_F(Target, SamplesOfLargeScenesAreSmallAndLoseTheirWalls) {
  changes_ = {"container.size=[1.0, 0.16, 1.0]", "container.boundary=[\"wall\", \"wall\"]"};
  const control::Sample sample = control::sample_of(scene());
  EXPECT_FALSE(sample.whole);
  EXPECT_EQ(sample.scene.in.container.size[1], 0.16);
  EXPECT_EQ(sample.scene.in.container.boundary[1], input::Boundary::wall);
  EXPECT_EQ(sample.scene.in.container.boundary[0], input::Boundary::periodic);
  EXPECT_LT(sample.scale, 1.0);
  EXPECT_GT(sample.particles, 1500.0);
  EXPECT_LT(sample.particles, 4000.0);
}

TEST_F(Target, ASampleOfAListHasItsSizesAsOftenAndAHeightOfItsOwn) {
  input::Input in = scene().in;
  in.container.size = {1.0, 1.0, 1.0};
  in.particles.radius.distribution = input::SizeDistribution::list;
  for (int k = 0; k < 60000; ++k) in.particles.radius.radii.push_back(k % 3 == 0 ? 0.012 : 0.009);
  in.particles.count = 60000;
  const scene::Scene whole = scene::build(in);
  const control::Sample sample = control::sample_of(whole);
  EXPECT_FALSE(sample.whole);
  EXPECT_EQ(sample.scene.in.particles.count, 0);
  EXPECT_NEAR(sample.scene.sizes.mean(), 0.01, 1e-12);
  EXPECT_NEAR(sample.scene.sizes.curve().moment(3), whole.sizes.curve().moment(3), 1e-15);
  EXPECT_EQ(sample.scene.sizes.largest(), 0.012);
  EXPECT_GT(sample.particles, 1500.0);
  EXPECT_LT(sample.particles, 4000.0);
}

}  // namespace
}  // namespace packmpi::run
