// Derived quantities: eq. (23), features, force quantum, and the checks that need them.
#include "scene/scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/error.hpp"
#include "input/time_step.hpp"
#include "support/scenes.hpp"

namespace packmpi::scene {
namespace {

using test::small_input;

std::string complaint(const input::Input& in) {
  try {
    (void)build(in);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    return error.what();
  }
  return "";
}

TEST(ContactDuration, IsEquation23) {
  // Two glass spheres of 10 mm at 20 m/s relative speed: Chung & Ooi give 40.34 us by the exact 2.9433 delta_max / v.
  const double m = 2800.0 * 4.0 / 3.0 * std::numbers::pi * 1e-6;
  const double modulus = 48e9 / (2.0 * (1.0 - 0.04));
  const double t = input::contact_duration(0.5 * m, 0.005, modulus, 20.0);
  EXPECT_NEAR(t, 40.34e-6, 0.01 * 40.34e-6);
}

TEST(ContactDuration,
     HasTheConstantOfThePaper) {  // t = 2.87 (m*^2 / (r* E*^2 v))^(1/5), in numbers without a mass or a radius
  EXPECT_NEAR(input::contact_duration(1.0, 1.0, 1.0, 1.0), 2.87, 1e-12);
  EXPECT_NEAR(input::contact_duration(32.0, 1.0, 1.0, 1.0), 2.87 * 4.0, 1e-12);
  EXPECT_NEAR(input::contact_duration(1.0, 32.0, 1.0, 1.0), 2.87 / 2.0, 1e-12);
  EXPECT_NEAR(input::contact_duration(1.0, 1.0, 32.0, 1.0), 2.87 / 4.0, 1e-12);
  EXPECT_NEAR(input::contact_duration(1.0, 1.0, 1.0, 1024.0), 2.87 / 4.0, 1e-12);
}

TEST(Scene, AutoTakesAFifthOfTheContactDuration) {
  input::Input in = small_input(3, 0.2, 0.02);
  in.dynamics.time_step.reset();
  const double m = 1000.0 * 4.0 / 3.0 * std::numbers::pi * 8e-6;
  const double expected =
      input::contact_duration(0.5 * m, 0.01, 1e8 / (2.0 * (1.0 - 0.0625)), std::sqrt(2.0 * 2.0 * 0.1)) / 5.0;
  EXPECT_DOUBLE_EQ(build(in).time_step, expected);
}

TEST(Scene, AutoIsSmallerForRoughParticlesWhoseSlipMayLastAStep) {
  input::Input in = small_input(3, 0.2, 0.02);
  in.dynamics.time_step.reset();
  const auto step = [&in](double friction, double wall_friction, input::Regularisation kind) {
    in.contact.friction = friction;
    in.contact.wall_friction = wall_friction;
    in.contact.regularisation = kind;
    return build(in).time_step;
  };
  using enum input::Regularisation;
  const double smooth = step(0.2, 0.2, stop);
  EXPECT_DOUBLE_EQ(step(0.0, 0.0, stop), smooth);
  EXPECT_NEAR(step(0.5, 0.5, stop), smooth / std::pow(2.5, 0.25), 1e-12 * smooth);
  EXPECT_EQ(step(0.2, 0.5, stop), step(0.5, 0.2, stop));
  EXPECT_DOUBLE_EQ(step(0.5, 0.5, none), smooth);
}

TEST(Scene, RefusesAStepBeyondEquation23AndTakesOneBelow) {
  input::Input in = small_input(3, 0.2, 0.02);
  in.dynamics.time_step = 2.4e-4;
  EXPECT_EQ(complaint(in), "");
  in.dynamics.time_step = 2.6e-4;
  EXPECT_NE(complaint(in).find("dynamics.time_step: 0.00026 s is beyond the limit of eq. (23)"), std::string::npos)
      << complaint(in);
}

TEST(Scene, RefusesDragThatStopsAParticleWithinAStep) {
  input::Input in = small_input(3, 0.2, 0.001);
  in.drag.coefficient = 1.0;
  in.dynamics.time_step = 1e-6;
  EXPECT_EQ(complaint(in), "");
  in.dynamics.time_step = 5e-6;
  EXPECT_NE(complaint(in).find("drag.coefficient"), std::string::npos);
}

TEST(Scene, RefusesAPeriodicAxisBelowThreeRanges) {
  input::Input in = test::periodic(small_input(3, 0.2, 0.02));
  EXPECT_EQ(complaint(in), "");  // 3 (2 r + skin) = 0.126
  in.container.size[0] = 0.125;
  EXPECT_NE(complaint(in).find("at least 0.126 m"), std::string::npos) << complaint(in);
}

TEST(Scene, FeaturesFollowTheInput) {
  input::Input in = small_input(3, 0.2, 0.02);
  EXPECT_EQ(build(in).features, (Features{3, true, true, false, false, false, false}));
  in.contact.friction = in.contact.wall_friction = 0.0;
  in.drag.coefficient = 0.005;
  in.dynamics.rotation = false;
  in.near_field = input::NearField{1e-9, 2.0, 0.0, 0.0, 0.06};
  EXPECT_EQ(build(in).features, (Features{3, false, false, true, true, false, false}));
  EXPECT_DOUBLE_EQ(build(in).reach, 0.06);
  EXPECT_EQ(build(test::periodic(test::graded_input(2, 0.2, 0.01, 1.5))).features,
            (Features{2, true, true, false, false, true, true}));
}

TEST(Scene, ForceQuantumIsAPowerOfTwoThatResolvesAWeightAndHoldsAnImpact) {
  for (const double modulus : {1e4, 1e8, 1e12}) {
    for (const double r : {1e-6, 0.02, 1e3}) {
      input::Input in = small_input(3, 10.0 * r, r);
      in.particles.youngs_modulus = modulus;
      in.jamming.gravity = 2.0 * std::min(1.0, modulus / (1e6 * r));  // beyond it the bed would be pressed flat
      in.dynamics.time_step.reset();
      const Scene scene = build(in);
      int exponent = 0;
      EXPECT_EQ(std::frexp(scene.force_quantum, &exponent), 0.5);
      const double weight = in.jamming.gravity * 1000.0 * 4.0 / 3.0 * std::numbers::pi * r * r * r;
      EXPECT_LT(scene.force_quantum, 1e-5 * weight) << modulus << " " << r;
      EXPECT_GT(scene.force_quantum * std::ldexp(1.0, 50), 10.0 * weight);
    }
  }
}

TEST(Scene, OfASoilWithGrainsTooLightItIsSaidWhatToLeaveOut) {
  input::Input in = small_input(3, 1.0, 0.01);
  in.particles.radius.distribution = input::SizeDistribution::grading;
  in.particles.radius.weighting = input::Weighting::mass;
  in.particles.radius.diameter_curve = {{2e-6, 0.0}, {6e-5, 10.0}, {2e-4, 30.0}, {2e-3, 60.0}, {2e-2, 100.0}};
  in.dynamics.time_step.reset();
  const std::string words = complaint(in), mark = "particles.radius.keep_percent = [";
  ASSERT_NE(words.find(mark), std::string::npos) << words;
  const double enough = std::stod(words.substr(words.find(mark) + mark.size()));
  in.particles.radius.keep_percent = {0.9 * enough, 100.0};
  EXPECT_NE(complaint(in).find(mark), std::string::npos);
  in.particles.radius.keep_percent = {enough, 100.0};
  EXPECT_EQ(complaint(in), "");
}

}  // namespace
}  // namespace packmpi::scene
