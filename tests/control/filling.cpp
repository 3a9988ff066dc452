// A density by the friction while filling: the knob, the sample's curve, and the loop against beds that differ from it.
#include "control/filling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "input/read.hpp"

namespace packmpi::control {
namespace {

const std::string scene_text =
    "[container]\nsize = [1.0, 1.0, 0.5]\n"
    "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e8\npoisson_ratio = 0.25\n"
    "radius = { distribution = \"equal\", value = 0.02 }\n"
    "[layers]\nthickness = 0.1\nfraction = 0.25\n[jamming]\ngravity = 2.0\n"
    "[contact]\ntangential = \"mindlin\"\nfriction = 0.5\nwall_friction = 0.25\nrolling_friction = 0.1\n"
    "twisting_friction = 0.05\n";

input::Input scene_with(const std::vector<std::string>& set) { return input::parse(scene_text, "box.toml", {set}); }

TEST(Filling, KnobScalesAllFriction) {
  const input::Input in = scene_with({"target.porosity=0.4"});
  EXPECT_EQ(loosest_knob(in), 1.0);
  const scene::Friction least = friction_of(in, 0.0);
  EXPECT_NEAR(least.particles, 1e-3, 1e-15);
  EXPECT_NEAR(least.walls, 5e-4, 1e-15);
  EXPECT_NEAR(least.rolling, 2e-4, 1e-15);
  EXPECT_NEAR(least.twisting, 1e-4, 1e-15);
  const scene::Friction own = friction_of(in, 1.0);
  EXPECT_NEAR(own.particles, 0.5, 1e-13);
  EXPECT_NEAR(own.walls, 0.25, 1e-13);
  EXPECT_NEAR(own.rolling, 0.1, 1e-13);
  EXPECT_NEAR(friction_of(in, 0.5).particles, std::sqrt(0.5e-3), 1e-13);
}

TEST(Filling, MoreThanTheScenesOwnWhereItIsAllowed) {
  const input::Input in =
      scene_with({"target.porosity=0.4", "target.most_friction=2", "target.most_rolling_friction=0.3"});
  EXPECT_EQ(loosest_knob(in), 2.0);
  EXPECT_NEAR(friction_of(in, 1.0).particles, 2.0, 1e-12);
  EXPECT_NEAR(friction_of(in, 1.0).rolling, 0.1, 1e-13);  // the scene's own at most
  EXPECT_NEAR(friction_of(in, 1.5).rolling, 0.2, 1e-13);
  EXPECT_NEAR(friction_of(in, 2.0).rolling, 0.3, 1e-13);
}

TEST(Filling, TheSameDensityInEveryTradesWords) {
  const Limits limits{0.55, 0.64};
  const auto wanted = [&](std::optional<double> input::Target::*word, double value) {
    input::Target target;
    target.*word = value;
    return fraction_wanted(target, limits);
  };
  EXPECT_EQ(wanted(&input::Target::solid_fraction, 0.6), 0.6);
  EXPECT_NEAR(wanted(&input::Target::porosity, 0.4), 0.6, 1e-15);
  EXPECT_NEAR(wanted(&input::Target::void_ratio, 2.0 / 3.0), 0.6, 1e-15);
  EXPECT_NEAR(wanted(&input::Target::relative_density, 0.0), 0.55, 1e-15);
  EXPECT_NEAR(wanted(&input::Target::relative_density, 1.0), 0.64, 1e-15);
  const double middle = wanted(&input::Target::relative_density, 0.5);
  EXPECT_NEAR((1.0 - middle) / middle, 0.5 * (0.45 / 0.55 + 0.36 / 0.64), 1e-14);
}

const std::vector<Trial> trials{{1.0, 0.571, 0.570, 4.6},
                                {0.0, 0.640, 0.640, 6.0},
                                {0.25, 0.638, 0.638, 6.0},
                                {0.5, 0.628, 0.627, 5.8},
                                {0.75, 0.602, 0.600, 5.2}};

TEST(Filling, CurveAndItsInverse) {
  const Filling curve = curve_of(trials);
  EXPECT_EQ(limits_of(curve).densest, 0.640);
  EXPECT_EQ(limits_of(curve).loosest, 0.570);
  EXPECT_EQ(knob_for(curve, 0.627), 0.5);
  EXPECT_NEAR(knob_for(curve, 0.585), 0.875, 1e-12);
  EXPECT_EQ(knob_for(curve, 0.7), 0.0);
  EXPECT_EQ(knob_for(curve, 0.5), 1.0);
  EXPECT_NEAR(filled_at(curve, 0.625), 0.615, 1e-15);
}

TEST(Filling, WhatRisesByChanceIsLevelled) {
  const Filling curve = curve_of({{0.0, 0.63, 0.63, 6.0}, {0.5, 0.64, 0.64, 6.0}, {1.0, 0.58, 0.58, 5.0}});
  EXPECT_NEAR(curve.relaxed[0], 0.635, 1e-15);
  EXPECT_NEAR(curve.relaxed[1], 0.635, 1e-15);
  EXPECT_EQ(curve.relaxed[2], 0.58);
}

// Two trials side by side, 0.004 apart by chance: their slope is not believed.
TEST(Filling, TrialsSideBySideAreOne) {
  std::vector<Trial> more = trials;
  more.push_back({0.60, 0.6190, 0.6195, 5.6});
  more.push_back({0.61, 0.6150, 0.6155, 5.6});
  const Filling curve = curve_of(more);
  ASSERT_EQ(curve.knobs.size(), 6U);
  EXPECT_NEAR(curve.knobs[3], 0.605, 1e-15);
  EXPECT_NEAR(curve.relaxed[3], 0.6175, 1e-15);
  EXPECT_NEAR(curve.filled[3], 0.6170, 1e-15);
  more.push_back({0.02, 0.6390, 0.6390, 6.0});  // beside an end, which stays
  EXPECT_EQ(curve_of(more).knobs.front(), 0.0);
  EXPECT_EQ(curve_of(more).relaxed.front(), 0.640);
}

/// A bed whose layers have `more` than the curve foresees; what its bulk comes to.
double filled_in(double more, double target) {
  constexpr double d = 1.0, rise = 2.0;
  std::vector<Trial> still = trials;  // of which the final relaxation changes nothing
  for (Trial& trial : still) trial.filled = trial.relaxed;
  Filling filling = curve_of(still);
  filling.on = true;
  filling.target = target;
  filling.knob = knob_for(filling, target);
  std::vector<double> layers;
  for (int layer = 1; layer <= 40; ++layer) {
    filling.layer_knobs.push_back(filling.knob);
    layers.push_back(filled_at(filling, filling.knob) + more);
    const double surface = layer * rise;
    const Slab slab = buried(surface, d);
    double sum = 0.0;
    for (std::size_t k = 0; k < layers.size(); ++k) {
      const double low = static_cast<double>(k) * rise;
      const double part = std::min(low + rise, slab.high) - std::max(low, slab.low);
      if (part > 0.0) sum += part * layers[k];
    }
    correct(filling, surface, slab, slab.depth() > 0.0 ? sum / slab.depth() : 0.0, {});
  }
  EXPECT_EQ(filling.layer_fractions.size(), 40U);
  double sum = 0.0;
  for (std::size_t k = 16; k < 36; ++k) sum += layers[k];
  return sum / 20.0;
}

// The layer below is pressed more: it is filled in looser by what will be gained, and a bed that has gained already is
// not taken for one that differs from its sample.
TEST(Filling, WhatWeightWillAddIsForeseen) {
  Filling filling = curve_of(trials);
  filling.on = true;
  filling.target = 0.60;
  const Knob alone = next_knob(filling, {});
  EXPECT_EQ(next_knob(filling, {.sample = 0.001, .ordered = 0.001, .now = 0.0, .next = 0.001}), alone);
  const Knob deep = next_knob(filling, {.sample = 0.001, .ordered = 0.001, .now = 0.0, .next = 0.004});
  EXPECT_NEAR(deep, knob_for(filling, 0.597), 1e-15);
  EXPECT_GT(deep, alone);
  // Under stress sample and bed gain alike; what the sample gains before it counts only for what is measured then.
  EXPECT_EQ(next_knob(filling, {.sample = 0.001, .ordered = 0.009, .now = 0.0, .next = 0.009}), alone);
  filling.layer_knobs = {alone};
  const Slab slab{2.0, 12.0, 1.0};
  correct(filling, 15.0, slab, filled_at(filling, alone) + 0.002,
          {.sample = 0.001, .ordered = 0.001, .now = 0.003, .next = 0.001});
  EXPECT_NEAR(filling.bias, 0.0, 1e-15);
  EXPECT_NEAR(filling.knob, alone, 1e-12);
}

// A slab near the floor is looser in the sample, too: that is no difference of the bed.
TEST(Filling, ASlabIsHeldAgainstThoseOfTheSample) {
  std::vector<Trial> some = trials;
  for (Trial& trial : some) trial.slabs = {0.0, 0.0, trial.filled - 0.004, trial.filled - 0.002};
  some[1].slabs = {0.0, 0.0, trials[1].filled - 0.005};  // one of fewer layers
  Filling filling = curve_of(some);
  ASSERT_EQ(filling.slab_excess.size(), 4U);
  EXPECT_EQ(filling.slab_excess[1], 0.0);
  EXPECT_NEAR(filling.slab_excess[2], -0.0042, 1e-15);
  EXPECT_NEAR(filling.slab_excess[3], -0.002, 1e-15);
  filling.on = true;
  filling.target = 0.60;
  const Slab slab{2.0, 12.0, 1.0};
  const double more[] = {0.0, 0.0, -0.0042, -0.002, -0.002};  // as the last one, where the sample has no more layers
  for (int layer = 0; layer < 5; ++layer) {
    filling.layer_knobs.push_back(0.75);
    correct(filling, 15.0 + layer, slab, filled_at(filling, 0.75) + more[layer], {});
    EXPECT_NEAR(filling.bias, 0.0, 1e-15) << layer;
  }
}

TEST(Filling, LayersCorrectWhatTheSampleDoesNotKnow) {
  for (const double more : {-0.008, 0.0, 0.004, 0.008}) EXPECT_NEAR(filled_in(more, 0.60), 0.60, 0.0012) << more;
}

TEST(Filling, NothingIsMeasuredOfALowBed) {
  EXPECT_EQ(buried(7.5, 1.0).depth(), 0.0);
  EXPECT_NEAR(buried(9.0, 1.0).low, 2.0, 1e-15);
  EXPECT_NEAR(buried(9.0, 1.0).high, 6.0, 1e-15);
  EXPECT_LT(buried(9.0, 1.0).weight, buried(40.0, 1.0).weight);
}

}  // namespace
}  // namespace packmpi::control
