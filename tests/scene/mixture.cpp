// Components: what their tables mean, what two of them make of a contact, how many of each there are.
#include "scene/mixture.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "input/read.hpp"

namespace packmpi::scene {
namespace {

const std::string around =
    "[container]\nsize = [1.0, 1.0, 0.5]\n[layers]\nthickness = 0.1\nfraction = 0.25\n[jamming]\ngravity = 2.0\n";
const std::string of_all =
    "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e8\npoisson_ratio = 0.25\n"
    "radius = { distribution = \"equal\", value = 0.02 }\n[contact]\nfriction = 0.4\ntangential = \"mindlin\"\n";

std::string two(const std::string& share_by, const std::string& more = "") {
  return around + of_all + "[mixture]\nshare_by = \"" + share_by +
         "\"\n[[component]]\nname = \"stone\"\nshare = 3\ndensity = 3000\nwall_friction = 0.1\nrolling_friction = "
         "0.09\n"
         "[[component]]\nname = \"cork\"\nshare = 1\ndensity = 200\nyoungs_modulus = \"20 MPa\"\npoisson_ratio = 0.1\n"
         "friction = 0.9\nrestitution = 0.5\nrolling_friction = 0.04\ndiameter = { distribution = \"equal\", value = "
         "\"2 cm\" }\n" +
         more;
}

input::Input parse(const std::string& text) { return input::parse(text, "a.toml", {}); }

TEST(Components, HaveOfAllWhatTheyDoNotSay) {
  const input::Input in = parse(two("mass"));
  ASSERT_EQ(in.components.size(), 2U);
  const input::Component &stone = in.components[0], &cork = in.components[1];
  EXPECT_EQ(stone.particles.youngs_modulus, 1e8);
  EXPECT_EQ(stone.particles.radius.value, 0.02);
  EXPECT_EQ(stone.friction, 0.4);
  EXPECT_EQ(stone.wall_friction, 0.1);
  EXPECT_EQ(cork.particles.radius.value, 0.01) << "a diameter";
  EXPECT_EQ(cork.wall_friction, 0.9) << "its own friction";
  EXPECT_EQ(cork.damping_ratio, parse(around + of_all + "restitution = 0.5\n").contact.damping_ratio);
  EXPECT_EQ(in.particles.youngs_modulus, 1e8) << "the stiffest and the lightest give the time step";
  EXPECT_EQ(in.particles.density, 200.0);
}

TEST(Components, EffectiveInputIsAFixedPoint) {
  const std::string strata =
      "[[pair]]\ncomponents = [\"cork\", \"stone\"]\nfriction = 0.2\n[[stratum]]\nname = \"low\"\ntop = \"20 "
      "cm\"\nshares = "
      "{ cork = 1 }\n[[stratum]]\n";
  for (const char* by : {"mass", "volume", "number"}) {
    const input::Input in = parse(two(by, strata)), again = parse(in.effective);
    EXPECT_EQ(again.effective, in.effective);
    EXPECT_EQ(again.pairs[0].friction, 0.2);
    EXPECT_EQ(again.strata[0].shares, (std::vector<double>{0.0, 1.0}));
  }
}

// The same scene to the letter: the same particles, bytes and steps.
TEST(Components, OneAloneIsNone) {
  const input::Input none = parse(around + of_all);
  const input::Input one = parse(around + of_all + "[[component]]\nname = \"stone\"\nshare = 1\n");
  EXPECT_EQ(one.effective, none.effective);
  EXPECT_FALSE(build(one).features.mixture);
  EXPECT_EQ(parse(around + "[contact]\ntangential = \"mindlin\"\n[[component]]\nname = \"stone\"\ndensity = "
                           "1000\nyoungs_modulus = 1e8\npoisson_ratio "
                           "= 0.25\nfriction = 0.4\nradius = { distribution = \"equal\", value = 0.02 }\n")
                .effective,
            none.effective);
}

// doc/howto_mixture.md: Hertz' and Mindlin's moduli, the geometric mean of the rest, and [[pair]] before it.
TEST(Components, MixByTheRuleThatIsWrittenDown) {
  const input::Input in = parse(two("mass"));
  const PairMaterial mixed = pair_material(in, 0, 1), other = pair_material(in, 1, 0);
  const double soft = (1.0 - 0.01) / 2e7, hard = (1.0 - 0.0625) / 1e8;
  EXPECT_DOUBLE_EQ(mixed.normal_modulus, 1.0 / (soft + hard));
  EXPECT_DOUBLE_EQ(mixed.shear_modulus, 1.0 / (1.9 * 2.2 / 2e7 + 1.75 * 2.5 / 1e8));
  EXPECT_DOUBLE_EQ(mixed.friction.particles, std::sqrt(0.4 * 0.9));
  EXPECT_DOUBLE_EQ(mixed.friction.rolling, std::sqrt(0.09 * 0.04));
  EXPECT_DOUBLE_EQ(mixed.damping_ratio, std::sqrt(in.components[0].damping_ratio * in.components[1].damping_ratio));
  EXPECT_EQ(mixed.normal_modulus, other.normal_modulus);
  EXPECT_EQ(mixed.friction.particles, other.friction.particles);
  EXPECT_DOUBLE_EQ(pair_material(in, 1, 1).friction.particles, 0.9) << "likes are what they are";
  const PairMaterial said =
      pair_material(parse(two("mass", "[[pair]]\ncomponents = [\"cork\", \"stone\"]\nfriction = 0.2\n")), 0, 1);
  EXPECT_EQ(said.friction.particles, 0.2);
  EXPECT_DOUBLE_EQ(said.friction.rolling, mixed.friction.rolling);
  EXPECT_EQ(wall_material(in, 0).friction.particles, 0.1);
  EXPECT_DOUBLE_EQ(wall_material(in, 1).normal_modulus, 1.0 / soft) << "the wall is rigid";
}

TEST(Components, SharesAreOfWhatIsSaid) {
  const double large = geometry::volume(3, 0.02), small = geometry::volume(3, 0.01);
  const auto ratio = [](const char* by) {
    const Recipe recipe = recipe_of(build(parse(two(by))), 0);
    EXPECT_NEAR(recipe.numbers[0] + recipe.numbers[1], 1.0, 1e-12);
    return recipe.numbers[0] / recipe.numbers[1];
  };
  EXPECT_NEAR(ratio("number"), 3.0, 1e-9);
  EXPECT_NEAR(ratio("volume") * large / small, 3.0, 1e-9);
  EXPECT_NEAR(ratio("mass") * large * 3000.0 / (small * 200.0), 3.0, 1e-9);
}

TEST(Components, CodesNameTheirPair) {
  std::set<int> sums;
  for (int a = 0; a < input::most_components; ++a) {
    for (int b = a; b < input::most_components; ++b) EXPECT_TRUE(sums.insert(code_of(a) + code_of(b)).second) << a << b;
  }
}

}  // namespace
}  // namespace packmpi::scene
