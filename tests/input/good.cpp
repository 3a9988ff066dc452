// Right scenes: every key arrives, defaults are the documented ones, units are exact, the effective input is a fixed
// point.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "cli/starter.hpp"
#include "config/restitution.hpp"
#include "config/vessel.hpp"
#include "input/fidelity.hpp"
#include "input/grading.hpp"
#include "input/keys.hpp"
#include "input/radius_range.hpp"
#include "input/read.hpp"
#include "input/time_step.hpp"
#include "tables/rhythm.hpp"
#include "tables/sieve_table.hpp"
#include "tables/units.hpp"

namespace packmpi::input {
namespace {

const std::string least =
    "[container]\nsize = [1.0, 1.0, 0.5]\n"
    "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e8\npoisson_ratio = 0.25\n"
    "radius = { distribution = \"equal\", value = 0.02 }\n"
    "[layers]\nthickness = 0.1\nfraction = 0.25\n[jamming]\ngravity = 2.0\n";

/// Every key of the table that can be given, none at its default.
const std::string full = R"(
schema_version = 1
seed = 9223372036854775807
fidelity = "paper"
[container]
dimension = 2
size = ["100 cm", 0.5]
boundary = ["periodic"]
[particles]
density = "2.5 g/cm3"
youngs_modulus = "100 MPa"
poisson_ratio = 0.3
[particles.radius]
distribution = "gaussian"
mean = "10 mm"
sd = "1000 um"
min = 0.007
max = 0.013
weighting = "number"
[layers]
thickness = 0.2
fraction = "40 %"
duration = "500 ms"
height = "highest"
region = "container"
velocity = [0.1, "-5 cm/s"]
spin = [3.0]
attempts = 77
maximum = 9
[jamming]
gravity = 3
[contact]
damping_ratio = 0.3
friction = 0.4
wall_friction = 0.5
friction_velocity = "centre"
regularisation = "viscous"
slip_time = "2 ms"
tension_cutoff = false
wall = "material"
[drag]
coefficient = "5 g/s"
fluid_velocity = [1.0, 2.0]
[near_field]
alpha1 = 1.5e-5
beta1 = 2.0
alpha2 = 2.5e-9
beta2 = 4.0
cutoff = "50 mm"
[dynamics]
rotation = true
theta = 0
time_step = "0.1 ms"
stop = "settled"
settled_energy = 1e-3
settled_drift = 2e-3
settled_hold = "0.1 s"
window = 3
relaxation = "0.6 s"
[rest]
unbalanced_force = 0.5
kinetic_energy = 0.02
support = 0.3
mean_overlap = "3 %"
worst_overlap = 0.06
wait = "70 ms"
[parallel]
decomposition = "metis"
[ensemble]
sets = 1
packs = 1
[output]
contacts = true
log_every = 0
[petsc]
options = "-log_view -implicit_snes_rtol 1e-9"
)";

TEST(GoodInput, EveryGeneralKeyArrives) {
  const Input in = parse(full, "some/where/brick.v2.toml", {});
  EXPECT_EQ(in.name, "brick.v2");
  EXPECT_EQ(in.file, "some/where/brick.v2.toml");
  EXPECT_EQ(in.seed, 9223372036854775807U);
  EXPECT_EQ(in.container.dimension, 2);
  EXPECT_EQ(in.container.size, (std::vector<double>{1.0, 0.5}));
  EXPECT_EQ(in.container.boundary, std::vector<Boundary>{Boundary::periodic});
  EXPECT_EQ(in.particles.density, 2500.0);
  EXPECT_EQ(in.particles.youngs_modulus, 1e8);
  EXPECT_EQ(in.particles.poisson_ratio, 0.3);
  const Radius& radius = in.particles.radius;
  EXPECT_EQ(radius.distribution, SizeDistribution::gaussian);
  EXPECT_EQ(radius.mean, 0.01);
  EXPECT_EQ(radius.sd, 0.001);
  EXPECT_EQ(radius.min, 0.007);
  EXPECT_EQ(radius.max, 0.013);
  EXPECT_EQ(radius.weighting, Weighting::number);
  EXPECT_EQ(in.layers.thickness, 0.2);
  EXPECT_EQ(in.layers.fraction, 0.4);
  EXPECT_EQ(in.layers.duration, 0.5);
  EXPECT_EQ(in.layers.height, HeightRule::highest);
  EXPECT_EQ(in.layers.region, RegionRule::container);
  EXPECT_EQ(in.layers.velocity, (Vec3{0.1, -0.05, 0.0}));
  EXPECT_EQ(in.layers.spin, (Vec3{0.0, 0.0, 3.0}));
  EXPECT_EQ(in.layers.attempts, 77);
  EXPECT_EQ(in.layers.maximum, 9);
}

TEST(GoodInput, EveryForceAndProgramKeyArrives) {
  const Input in = parse(full, "a.toml", {});
  EXPECT_EQ(in.jamming.gravity, 3.0);
  EXPECT_EQ(in.contact.damping_ratio, 0.3);
  EXPECT_EQ(in.contact.friction, 0.4);
  EXPECT_EQ(in.contact.wall_friction, 0.5);
  EXPECT_EQ(in.contact.friction_velocity, FrictionVelocity::centre);
  EXPECT_EQ(in.contact.regularisation, Regularisation::viscous);
  EXPECT_EQ(in.contact.slip_time, 0.002);
  EXPECT_FALSE(in.contact.tension_cutoff);
  EXPECT_EQ(in.contact.wall, WallStiffness::material);
  EXPECT_EQ(in.drag.coefficient, 0.005);
  EXPECT_EQ(in.drag.fluid_velocity, (Vec3{1.0, 2.0, 0.0}));
  ASSERT_TRUE(in.near_field.has_value());
  EXPECT_EQ(in.near_field->alpha1, 1.5e-5);
  EXPECT_EQ(in.near_field->beta1, 2.0);
  EXPECT_EQ(in.near_field->alpha2, 2.5e-9);
  EXPECT_EQ(in.near_field->beta2, 4.0);
  EXPECT_EQ(in.near_field->cutoff, 0.05);
  EXPECT_EQ(in.dynamics.time_step, 1e-4);
  EXPECT_EQ(in.dynamics.stop, StopRule::settled);
  EXPECT_EQ(in.dynamics.settled_drift, 2e-3);
  EXPECT_EQ(in.dynamics.settled_hold, 0.1);
  EXPECT_EQ(in.dynamics.window, 3);
  EXPECT_EQ(in.dynamics.relaxation, 0.6);
  EXPECT_EQ(in.rest.unbalanced_force, 0.5);
  EXPECT_EQ(in.rest.kinetic_energy, 0.02);
  EXPECT_EQ(in.rest.support, 0.3);
  EXPECT_EQ(in.rest.mean_overlap, 0.03);
  EXPECT_EQ(in.rest.worst_overlap, 0.06);
  EXPECT_EQ(in.rest.wait, 0.07);
  EXPECT_EQ(in.parallel.decomposition, Decomposition::metis);
  EXPECT_TRUE(in.output.contacts);
  EXPECT_EQ(in.output.log_every, 0.0);
  EXPECT_EQ(in.petsc.options, "-log_view -implicit_snes_rtol 1e-9");
}

TEST(GoodInput, DefaultsAreTheDocumentedOnes) {
  const Input in = parse(least, "a.toml", {});
  EXPECT_EQ(in.seed, 1U);
  EXPECT_EQ(in.fidelity, "paper");
  EXPECT_EQ(in.container.dimension, 3);
  EXPECT_EQ(in.container.boundary, (std::vector<Boundary>{Boundary::wall, Boundary::wall}));
  EXPECT_EQ(in.layers.duration, 1.0);
  EXPECT_EQ(in.layers.height, HeightRule::surface);
  EXPECT_EQ(in.layers.region, RegionRule::open);
  EXPECT_EQ(in.layers.velocity, Vec3{});
  EXPECT_EQ(in.layers.spin, Vec3{});
  EXPECT_EQ(in.layers.attempts, 10000);
  EXPECT_EQ(in.layers.maximum, 0);
  EXPECT_EQ(in.contact.damping_ratio, 0.1);
  EXPECT_EQ(in.contact.friction, 0.2);
  EXPECT_EQ(in.contact.wall_friction, 0.2);
  EXPECT_EQ(in.contact.friction_velocity, FrictionVelocity::contact);
  EXPECT_EQ(in.contact.regularisation, Regularisation::shared);
  EXPECT_FALSE(in.contact.restitution.has_value());
  EXPECT_TRUE(in.contact.tension_cutoff);
  EXPECT_EQ(in.contact.wall, WallStiffness::rigid);
  EXPECT_EQ(in.drag.coefficient, 0.0);
  EXPECT_FALSE(in.near_field.has_value());
  EXPECT_TRUE(in.dynamics.rotation);
  EXPECT_FALSE(in.dynamics.time_step.has_value());
  EXPECT_EQ(in.rest.unbalanced_force, 0.05);
  EXPECT_EQ(in.rest.kinetic_energy, 1e-4);
  EXPECT_EQ(in.rest.support, 0.02);
  EXPECT_EQ(in.rest.mean_overlap, 0.01);
  EXPECT_EQ(in.rest.worst_overlap, 0.05);
  EXPECT_FALSE(in.rest.wait.has_value());
  EXPECT_EQ(in.parallel.decomposition, Decomposition::slab);
  EXPECT_FALSE(in.output.contacts);
  EXPECT_EQ(in.output.log_every, std::nullopt);
  EXPECT_EQ(in.petsc.options, "");
}

/// The scene `least` with these keys.
Input with(const std::vector<std::string>& set) { return parse(least, "a.toml", {set}); }

// m* x'' + d* x' + F = 0 from first touch to where the force ends, in steps so small that the curve is exact: units in
// which m*, the impact speed and the stiffness of F = x^(3/2) are 1.
double restitution_by_steps(double xi, bool cutoff) {
  const auto force = [&](double x, double v) {
    return x * std::sqrt(x) + 2.0 * xi * std::sqrt(1.5) * std::sqrt(std::sqrt(x)) * v;
  };
  constexpr double dt = 2e-5;
  double x = 0.5 * dt, v = 1.0;  // staggered; nothing happens before
  while (true) {
    const double middle = v - 0.5 * dt * force(x, v);
    const double f = force(x, middle);
    if (cutoff && f < 0.0) return -v;
    v -= dt * f;
    x += dt * v;
    if (x <= 0.0) return -v;
  }
}

TEST(Restitution, IsTheCurveOfTheContactLaw) {
  for (const double xi : {0.01, 0.1, 0.3, 0.7}) {
    EXPECT_NEAR(restitution_of(xi, true), restitution_by_steps(xi, true), 2e-4) << xi;
    EXPECT_NEAR(restitution_of(xi, false), restitution_by_steps(xi, false), 2e-4) << xi;
  }
  EXPECT_NEAR(restitution_of(1.0, true), 0.1196, 5e-5);  // measured in whole runs: doc/extremes.md
  EXPECT_NEAR(restitution_of(5.0, true), 0.0078, 5e-5);
  EXPECT_EQ(restitution_of(0.0, true), 1.0);
  EXPECT_NEAR(restitution_of(1.0 / std::sqrt(1.2), true), std::exp(-2.0), 1e-7);
  EXPECT_EQ(restitution_of(0.95, false), 0.0) << "they stay together";
}

TEST(Restitution, AndDampingAreInversesOfEachOther) {
  for (const bool cutoff : {true, false}) {
    EXPECT_EQ(damping_of(1.0, cutoff), 0.0);
    for (const double e : {0.999, 0.9, 0.5, 0.14, 0.1353352832, 0.13, 0.05, 1e-3, 1e-6}) {
      EXPECT_NEAR(restitution_of(damping_of(e, cutoff), cutoff), e, 1e-12) << e;
    }
  }
}

TEST(Restitution, IsTheOtherWayToSayDamping) {
  const Input in = with({"contact.restitution=0.5"});
  EXPECT_EQ(in.contact.damping_ratio, damping_of(0.5, true));
  EXPECT_EQ(parse(in.effective, "a.toml", {}).effective, in.effective) << "both are there, and say the same";
  const Input literal = with({"contact.restitution=0.5", "contact.tension_cutoff=false"});
  EXPECT_EQ(literal.contact.damping_ratio, damping_of(0.5, false));
  EXPECT_LT(literal.contact.damping_ratio, in.contact.damping_ratio) << "what pulls while it parts damps more";
  EXPECT_EQ(with({"contact.restitution=1"}).contact.damping_ratio, 0.0);
}

TEST(Fidelity, PaperIsAFixedStepAndDurationAndAllMove) {
  const Input in = with({"fidelity=paper"});
  EXPECT_EQ(in.dynamics.time_step, 1e-4);
  EXPECT_EQ(in.layers.duration, 1.0);
  EXPECT_EQ(in.dynamics.window, 0);
  EXPECT_FALSE(in.layers.youngs_modulus.has_value());
}

TEST(Fidelity, PaperHasTheLawOfThePaperAndTheRestThatItsBedsCreepAt) {
  const Input in = with({"fidelity=paper"});
  EXPECT_EQ(in.contact.regularisation, Regularisation::stop);
  EXPECT_EQ(in.rest.kinetic_energy, 0.1);
  EXPECT_EQ(in.rest.wait, 0.0) << "a layer is a second, and the pack is what is there then";
  EXPECT_EQ(in.rest.mean_overlap, with({}).rest.mean_overlap);
  EXPECT_EQ(with({"fidelity=paper", "rest.kinetic_energy=1e-3"}).rest.kinetic_energy, 1e-3)
      << "a key that is named wins";
  EXPECT_EQ(with({"fidelity=paper", "dynamics.time_step=auto", "contact.regularisation=shared",
                  "rest={unbalanced_force=0.05,kinetic_energy=1e-4,support=0.02,wait=\"auto\"}"})
                .effective,
            with({}).effective)
      << "without the key, each key has its own default";
}

/// The presets for friction without memory.
constexpr const char* sliding = "contact.tangential=sliding";

TEST(Fidelity, PresetsAreKeysOfTheEffectiveInput) {
  for (const char* name : {"fidelity=balanced", "fidelity=draft"}) {
    for (const char* dimension : {"container.dimension=3", "container.dimension=2"}) {
      for (const char* rotation : {"dynamics.rotation=true", "dynamics.rotation=false"}) {
        std::vector<std::string> set{name, sliding, dimension, rotation};
        if (std::string(dimension).ends_with('2')) set.emplace_back("container.size=[1.0, 0.5]");
        const Input in = with(set);
        EXPECT_LT(in.layers.duration, 1.0) << name;
        EXPECT_LT(in.layers.velocity[in.container.size.size() - 1], 0.0) << name;
        EXPECT_GT(in.dynamics.relaxation, 0.0) << name;
        EXPECT_EQ(parse(in.effective, "a.toml", {}).effective, in.effective) << name;
        for (const PresetValue& entry : preset(in)) {
          std::string line(entry.path.substr(entry.path.rfind('.') + 1));
          line.insert(0, 1, '\n').append(" = ");
          EXPECT_NE(in.effective.find(line), std::string::npos) << entry.path;
        }
      }
    }
  }
}

TEST(Fidelity, GivenKeysWin) {
  const Input in =
      with({"fidelity=balanced", sliding, "layers.duration=0.77", "dynamics.window=9", "layers.youngs_modulus=5e7"});
  EXPECT_EQ(in.layers.duration, 0.77);
  EXPECT_EQ(in.dynamics.window, 9);
  EXPECT_EQ(in.layers.youngs_modulus, 5e7);
  EXPECT_EQ(in.dynamics.relaxation, with({"fidelity=balanced", sliding}).dynamics.relaxation) << "the others stay";
  const std::vector<std::string> lines = preset_in_use(in);
  EXPECT_TRUE(std::ranges::any_of(
      lines, [](const std::string& line) { return line.starts_with("layers.duration = 0.77 (the preset: 0."); }));
  EXPECT_EQ(std::ranges::count_if(lines, [](const auto& line) { return line.find("the preset") != line.npos; }),
            std::ranges::count_if(preset(in), [](const auto& entry) {
              return entry.path == "layers.duration" || entry.path == "dynamics.window" ||
                     entry.path == "layers.youngs_modulus";
            }));
}

TEST(Fidelity, TimesGoWithTheFreeFallThroughALayer) {
  const Input in = with({"fidelity=draft", sliding});
  const Input heavy = with({"fidelity=draft", sliding, "jamming.gravity=8.0"});  // four times as much
  const Input thick = with({"fidelity=draft", sliding, "layers.thickness=0.4"});
  EXPECT_NEAR(heavy.layers.duration, 0.5 * in.layers.duration, 0.01 * in.layers.duration);
  EXPECT_NEAR(thick.layers.duration, 2.0 * in.layers.duration, 0.01 * in.layers.duration);
  EXPECT_NEAR(*heavy.dynamics.relaxation, 0.5 * *in.dynamics.relaxation, 0.01 * *in.dynamics.relaxation);
  EXPECT_LT(*thick.dynamics.relaxation, 2.0 * *in.dynamics.relaxation) << "the bed is less deep in layers";
  EXPECT_NEAR(heavy.layers.velocity[2], 2.0 * in.layers.velocity[2], 0.01 * -in.layers.velocity[2]);
}

constexpr const char* few_sizes =
    "particles.radius={ distribution = \"uniform\", min = 0.015, max = 0.025, weighting = \"number\" }";

/// What a bed of a scene creeps by, over that of "paper": layers and relaxation as "balanced" has them.
double creep_over_paper(const Input& in) {
  const RadiusRange radii = radius_range(in.particles.radius);
  const double t2 = 2.0 * in.layers.thickness / in.jamming.gravity, n = 0.6 / 0.25 * 0.5 / in.layers.thickness;
  const double window = static_cast<double>(in.dynamics.window);
  double moves = 0.0;  // layers' durations in which the mean particle moves
  for (int layer = 0; layer < static_cast<int>(n + 0.5); ++layer) moves += std::min(window, n - layer) / n;
  const double hard = in.particles.youngs_modulus;
  const double layers = moves * in.layers.duration * automatic_step(in, radii, in.layers.youngs_modulus.value_or(hard));
  return (layers + *in.dynamics.relaxation * automatic_step(in, radii, hard)) / (0.5 * (n + 1.0) * 1e-3 * t2);
}

TEST(Fidelity, PilesCreepAsMuchAsTheyAreToWhateverTheirParticles) {
  const double on = 2.45 * std::sqrt(0.4), off = 1.14 * std::pow(0.4, 0.15);
  EXPECT_NEAR(creep_over_paper(with({"fidelity=balanced", sliding})), on, 0.01 * on);
  EXPECT_NEAR(creep_over_paper(with({"fidelity=balanced", sliding, "particles.youngs_modulus=3e8"})), on, 0.01 * on);
  EXPECT_NEAR(creep_over_paper(with({"fidelity=balanced", sliding, "contact.friction=0.5"})), on * std::pow(0.4, 0.25),
              0.01 * on);
  EXPECT_NEAR(creep_over_paper(with({"fidelity=balanced", sliding, "particles.density=3000.0"})), on, 0.01 * on);
  EXPECT_NEAR(creep_over_paper(with({"fidelity=balanced", sliding, "jamming.gravity=8.0"})), on, 0.01 * on);
  EXPECT_NEAR(creep_over_paper(with({"fidelity=balanced", sliding, "dynamics.rotation=false"})), off, 0.01 * off);
  EXPECT_NEAR(
      creep_over_paper(with({"fidelity=balanced", sliding, "dynamics.rotation=false", "particles.radius.value=0.01"})),
      off * std::pow(0.5, 0.15), 0.01 * off);
  EXPECT_NEAR(creep_over_paper(with({"fidelity=balanced", sliding, "dynamics.rotation=false", "contact.friction=0.4"})),
              off * std::pow(0.5, 0.35), 0.01 * off);
  const double graded = 2.45 * std::sqrt(2.0 * std::sqrt(0.015 * 0.025) / 0.1);
  EXPECT_NEAR(creep_over_paper(with({"fidelity=balanced", sliding, few_sizes})), graded, 0.01 * graded);
}

TEST(Fidelity, TheRelaxationIsALittleShorterWhereTheShortestLayersWouldLetAPileCreepByTooMuch) {
  const auto relaxation = [](const char* modulus) {
    const Input in = with({"fidelity=balanced", sliding, "dynamics.rotation=false", "contact.friction=0.4", modulus});
    return *in.dynamics.relaxation;
  };
  const double usual = (2.0 + 0.18 * 5.0) * std::sqrt(2.0 * 0.1 / 2.0);
  EXPECT_NEAR(relaxation("particles.youngs_modulus=1e8"), usual, 0.005 * usual);
  EXPECT_NEAR(relaxation("particles.youngs_modulus=2e6"), 0.95 * usual, 0.005 * usual) << "steps 4.8 times as long";
}

TEST(Fidelity, LayersAreAsSoftAsThePileBearsAndNoSofterThanItPays) {
  const auto modulus = [](const char* name, const char* particles) {
    const Input in = with({name, sliding, particles, few_sizes});
    return in.layers.youngs_modulus.value_or(in.particles.youngs_modulus);
  };
  // rho g H_d is 1000 Pa here; 2e3 and 1.3e3 of it are the least
  EXPECT_GT(with({"fidelity=balanced", sliding}).layers.youngs_modulus, 1.2 * 0.06 * 1e8)
      << "no softer than the creep asks for";
  EXPECT_EQ(modulus("fidelity=balanced", "particles.youngs_modulus=3e10"), 0.06 * 3e10);
  EXPECT_EQ(modulus("fidelity=draft", "particles.youngs_modulus=3e10"), 0.03 * 3e10);
  EXPECT_EQ(modulus("fidelity=balanced", "particles.youngs_modulus=1e7"), 1e7) << "large steps as it is";
  EXPECT_EQ(modulus("fidelity=balanced", "particles.youngs_modulus=2e6"), 2e6);
  const Input high = with({"fidelity=balanced", sliding, "container.size=[1.0, 1.0, 5.0]"});
  EXPECT_EQ(high.layers.youngs_modulus, 2e3 * 1e4) << "the stress of the bed";
}

TEST(Fidelity, AWindowIsSoManyParticlesDeep) {
  const auto window = [](const char* name, const char* radius) {
    return with({name, sliding, std::string("particles.radius.value=") + radius}).dynamics.window;
  };
  EXPECT_EQ(window("fidelity=balanced", "0.02"), 6);  // a layer lifts the bed by 0.0417 m
  EXPECT_EQ(window("fidelity=balanced", "0.002"), 5) << "at least";
  EXPECT_EQ(window("fidelity=draft", "0.02"), 4);
  EXPECT_EQ(window("fidelity=draft", "0.002"), 3) << "at least";
}

TEST(Fidelity, PresetsButPaperHaveFrictionWithMemory) {
  EXPECT_EQ(with({}).contact.tangential, Tangential::sliding);
  EXPECT_EQ(with({"fidelity=paper"}).contact.tangential, Tangential::sliding);
  for (const char* name : {"fidelity=reference", "fidelity=balanced", "fidelity=draft"}) {
    const Input in = with({name, "contact.rolling_friction=0.1"});  // a key of that law
    EXPECT_EQ(in.contact.tangential, Tangential::mindlin) << name;
    EXPECT_EQ(parse(in.effective, "a.toml", {}).effective, in.effective) << name;
  }
}

TEST(Fidelity, WithMemoryLayersGetTheTimeToSettle) {
  const double fall = std::sqrt(2.0 * 0.1 / 2.0);
  const Input reference = with({"fidelity=reference"}), balanced = with({"fidelity=balanced"});
  const Input draft = with({"fidelity=draft"});
  EXPECT_NEAR(reference.layers.duration, 5.0 * fall, 0.005 * fall);
  EXPECT_EQ(reference.dynamics.window, 0) << "all move";
  EXPECT_FALSE(reference.layers.youngs_modulus.has_value()) << "hard";
  EXPECT_EQ(reference.layers.velocity[2], 0.0);
  EXPECT_NEAR(balanced.layers.duration, 1.2 * fall, 0.005 * fall);
  EXPECT_NEAR(balanced.layers.velocity[2], -0.3 * 2.0 * fall, 0.005 * fall);
  EXPECT_NEAR(*balanced.dynamics.relaxation, 3.0 * fall, 0.005 * fall);
  EXPECT_EQ(balanced.dynamics.window, 10) << "10 diameters of 0.04 m, 0.0417 m a layer";
  EXPECT_FALSE(balanced.layers.youngs_modulus.has_value()) << "hard";
  EXPECT_NEAR(draft.layers.duration, 0.9 * fall, 0.005 * fall);
  EXPECT_EQ(draft.dynamics.window, 6);
  EXPECT_EQ(draft.layers.youngs_modulus, 1e7);
}

TEST(Fidelity, LayersAreStifferWhereLargeParticlesPressSmallOnes) {
  const auto modulus = [](const char* small) {
    return with({"fidelity=draft", std::string("particles.radius={ distribution = \"bidisperse\", small = ") + small +
                                       ", large = 0.02, large_share = 0.5, weighting = \"mass\" }"})
        .layers.youngs_modulus.value_or(1e8);
  };
  EXPECT_EQ(modulus("0.005"), 1e7) << "four to one";
  EXPECT_EQ(modulus("0.002"), 1e8) << "ten to one";
  EXPECT_NEAR(modulus("0.0032"), 1e7 * std::pow(1.25, 4), 1e5) << "6.25 to one";
}

double step_of(std::vector<std::string> set) {
  const Input in = with(std::move(set));
  return automatic_step(in, radius_range(in.particles.radius), in.particles.youngs_modulus);
}

TEST(TimeStep, WithMemoryItHeedsTheWeightOfTheBed) {
  const std::string memory = "contact.tangential=mindlin", high = "container.size=[1.0, 1.0, 8.0]";
  const std::string low = "container.size=[1.0, 1.0, 0.2]";
  EXPECT_EQ(step_of({memory, low}), step_of({sliding, low})) << "the impact is harder than the weight";
  const double deep = step_of({memory, high}), deeper = step_of({memory, "container.size=[1.0, 1.0, 16.0]"});
  EXPECT_LT(deep, step_of({sliding, high}));
  EXPECT_NEAR(deeper / deep, std::pow(0.5, 1.0 / 6.0), 1e-9)
      << "stiffness goes with the sixth root of the stress, squared";
  EXPECT_LT(step_of({memory, high, "contact.damping_ratio=0.4"}), 0.8 * deep);
  EXPECT_GT(step_of({memory, high, "dynamics.rotation=false"}), deep);
  const std::string mixed =
      "particles.radius={ distribution = \"bidisperse\", small = 0.002, large = 0.02, large_share = 0.5, weighting = "
      "\"mass\" }";
  const std::string small = "particles.radius={ distribution = \"equal\", value = 0.002 }";
  EXPECT_NEAR(step_of({memory, high, small}) / step_of({memory, high, mixed}), std::pow(2.0, 0.25) * std::cbrt(10.0),
              1e-9);
}

TEST(GoodInput, WallFrictionFollowsFriction) {
  EXPECT_EQ(parse(least, "a.toml", {{"contact.friction=0.7"}}).contact.wall_friction, 0.7);
}

TEST(GoodInput, UniformRadii) {
  const Input in =
      parse(least, "a.toml",
            {{"particles.radius={ distribution = \"uniform\", min = 0.01, max = \"2 cm\", weighting = \"number\" }"}});
  EXPECT_EQ(in.particles.radius.distribution, SizeDistribution::uniform);
  EXPECT_EQ(in.particles.radius.min, 0.01);
  EXPECT_EQ(in.particles.radius.max, 0.02);
}

/// The radii of a scene with this radius table.
Radius radius_of(const std::string& table, const std::optional<CurveFile>& curve = {}) {
  const Input in = parse(least, "a.toml", {{"particles.radius={ " + table + " }"}}, {.curve = curve});
  EXPECT_EQ(parse(in.effective, "b.toml", {}).effective, in.effective) << table;
  return in.particles.radius;
}

TEST(GoodInput, EveryKeyOfEverySizeDistributionArrives) {
  const Radius lognormal = radius_of(
      R"(distribution = "lognormal", median = "1 cm", log_sd = 0.4, min = "4 mm", max = "2 cm", weighting = "mass")");
  EXPECT_EQ(lognormal.median, 0.01);
  EXPECT_EQ(lognormal.log_sd, 0.4);
  EXPECT_EQ(lognormal.weighting, Weighting::mass);
  const Radius weibull =
      radius_of(R"(distribution = "weibull", scale = 0.01, shape = 3, min = 0.004, max = 0.02, weighting = "mass")");
  EXPECT_EQ(weibull.scale, 0.01);
  EXPECT_EQ(weibull.shape, 3.0);
  const Radius two = radius_of(
      R"(distribution = "bidisperse", small = "2 mm", large = "2 cm", large_share = "70 %", weighting = "mass")");
  EXPECT_EQ(two.small, 0.002);
  EXPECT_EQ(two.large, 0.02);
  EXPECT_EQ(two.large_share, 0.7);
  const Radius classes = radius_of(
      R"(distribution = "discrete", radii = ["2 mm", 0.004, "1 cm"], shares = [1, 2.5, 3], weighting = "number")");
  EXPECT_EQ(classes.radii, (std::vector<double>{0.002, 0.004, 0.01}));
  EXPECT_EQ(classes.shares, (std::vector<double>{1.0, 2.5, 3.0}));
  const Radius grading = radius_of(
      R"(distribution = "grading", diameter_curve = [["2 mm", 0], [0.01, 40.5], ["4 cm", 100]], weighting = "mass", )"
      R"(interpolation = "linear", keep_percent = [5, 100])");
  EXPECT_EQ(grading.diameter_curve, (Curve{{0.002, 0.0}, {0.01, 40.5}, {0.04, 100.0}}));
  EXPECT_EQ(grading.interpolation, Interpolation::linear);
  EXPECT_EQ(grading.keep_percent, (std::array<double, 2>{5.0, 100.0}));
}

TEST(GoodInput, AGradingFileIsTheSameAsItsPoints) {
  const CurveFile file{"g.csv", "# sieves\r\ndiameter_mm, percent_passing\r\n2 , 0\r\n\r\n10,40.5\r\n40,100"};
  const Radius radius =
      radius_of(R"(distribution = "grading", diameter_curve_file = "g.csv", weighting = "mass")", file);
  EXPECT_EQ(radius.diameter_curve, (Curve{{0.002, 0.0}, {0.01, 40.5}, {0.04, 100.0}}));
  EXPECT_EQ(radius.diameter_curve_file, "") << "the effective input needs no file";
  EXPECT_EQ(radius.interpolation, Interpolation::log);
}

struct Table {
  const char *text, *reading;
};

// A sand, as it comes from a sheet: the same curve, to the bit, however it is written.
TEST(GoodInput, SieveTablesAreReadAsPeopleHaveThem) {
  const Curve sand{{0.002, 0.0}, {0.004, 25.0}, {0.008, 62.5}, {0.016, 100.0}};
  const std::string sieves = ": 4 sieves, diameters 0.002 to 0.016 m";
  for (const auto& [text, reading] : {
           Table{"\xef\xbb\xbf"
                 "diameter_mm,percent_passing\r\n2,0\r\n4,25\r\n8,62.5\r\n16,100\r\n",
                 "percent passing over diameters in mm, with a byte-order mark"},
           Table{"Sieve [mm];Percent finer [%]\n16,0;100\n8,0;62,5\n4,0;25\n2,0;0\n",
                 "percent passing over diameters in mm, coarsest first, decimal commas"},
           Table{"sep=;\nradius_mm;passing\n4;62.5 %\n1;0 %\n8;100 %\n2;25 %\n",
                 "percent passing over radii in mm, in no order"},
           Table{"\"size (\xc2\xb5m)\",\"% passing\"\n\"2000\",\"0\"\n4000,25\n8000,\"62,5\"\n16000,100\n",
                 "percent passing over diameters in \xc2\xb5m, decimal commas"},
           Table{"sieve_mm\tpercent_retained\n16\t0\n8\t37.5\n4\t37.5\n2\t25\npan\t0\n",
                 "retained by sieve over diameters in mm, coarsest first, with a pan"},
           Table{"sieve_mm,percent_retained\n16,0\n8,37.5\n4,75\n2,100\n",
                 "cumulative retained over diameters in mm, coarsest first"},
           Table{"sieve_cm,mass retained (g)\n1.6,0\n0.8,300\n0.4,300\n0.2,200\nPan,0\n",
                 "mass, retained by sieve over diameters in cm, coarsest first, with a pan"},
           Table{"sieve_mm;cumulative mass retained (g)\n16;0\n8;300\n4;600\n2;800\npan;800\n",
                 "mass, cumulative retained over diameters in mm, coarsest first, with a pan"},
           Table{"sample,sieve_mm,mass_retained_g,percent_passing\na,16,0,100\na,8,300,62.5\na,4,300,25\na,2,200,0\n",
                 "percent passing over diameters in mm (columns 4 and 2), coarsest first"},
       }) {
    const tables::SieveTable table = tables::read_sieve_table({"g.csv", text});
    EXPECT_EQ(table.curve, sand) << text;
    EXPECT_EQ(table.reading, "g.csv: read as " + std::string(reading) + sieves);
  }
}

TEST(GoodInput, WhatPassesTheFinestSieveMayBeLeftOut) {
  const CurveFile file{"g.csv", "sieve_mm,mass_retained_g\n40,0\n20,150\n10,40\npan,10\n"};
  const std::string table =
      R"(distribution = "grading", diameter_curve_file = "g.csv", weighting = "mass", keep_percent = [5, 100])";
  const Radius radius = radius_of(table, file);
  EXPECT_EQ(radius.diameter_curve, (Curve{{0.01, 5.0}, {0.02, 25.0}, {0.04, 100.0}}));
  EXPECT_EQ(kept_curve(radius).front(), (std::array<double, 2>{0.01, 0.0}));
  EXPECT_EQ(
      parse(least, "a.toml", {{"particles.radius={ " + table + " }"}}, {.curve = file}).remarks,
      std::vector<std::string>{"g.csv: read as mass, retained by sieve over diameters in mm, coarsest first, with a "
                               "pan: 3 sieves, diameters 0.01 to 0.04 m"});
}

TEST(GoodInput, DiametersStandForRadii) {
  const auto of = [](const std::string& table) {
    std::string text = least;
    text.replace(text.find("radius = "), std::string("radius = { distribution = \"equal\", value = 0.02 }").size(),
                 "diameter = { " + table + " }");
    return parse(text, "a.toml", {});
  };
  EXPECT_EQ(of(R"(distribution = "equal", value = "40 mm")").effective, parse(least, "a.toml", {}).effective);
  const Radius gaussian =
      of(R"(distribution = "gaussian", mean = 0.04, sd = 0.004, min = "30 mm", max = 0.05, weighting = "area")")
          .particles.radius;
  EXPECT_EQ((std::array{gaussian.mean, gaussian.sd, gaussian.min, gaussian.max}),
            (std::array{0.02, 0.002, 0.015, 0.025}));
  EXPECT_EQ(gaussian.weighting, Weighting::area);
  EXPECT_EQ(of(R"(distribution = "list", diameters = [0.02, "4 cm"])").particles.radius.radii,
            (std::vector<double>{0.01, 0.02}));
  const Radius curve =
      of(R"(distribution = "grading", weighting = "mass", diameter_curve = [[0.04, 100], [0.02, 0]])").particles.radius;
  EXPECT_EQ(curve.diameter_curve, (Curve{{0.02, 0.0}, {0.04, 100.0}})) << "diameters in either table, sorted";
  EXPECT_FALSE(curve.diameters) << "all are radii now";
}

TEST(GoodInput, AListOfSizesIsANumberOfParticles) {
  const CurveFile file{"grains.csv",
                       "\xef\xbb\xbf"
                       "no;diameter_mm;mass_g\r\n1;20,5;3\r\n2;40;4\r\n3;20,5;3\r\n"};
  const std::string table =
      "particles.radius={ distribution = \"list\", list_file = \"grains.csv\", order = \"file\" }";
  const Input in = parse(least, "a.toml", {{table}}, {.curve = file});
  EXPECT_EQ(in.particles.radius.radii, (std::vector<double>{0.01025, 0.02, 0.01025}));
  EXPECT_EQ(in.particles.count, 3);
  EXPECT_EQ(in.remarks, std::vector<std::string>{"grains.csv: read as diameters in mm, decimal commas, with a "
                                                 "byte-order mark: 3 sizes, diameters 0.0205 to 0.04 m"});
  const Input again = parse(in.effective, "b.toml", {});
  EXPECT_EQ(again.effective, in.effective) << "it needs no file";
  EXPECT_EQ(again.particles.radius.order, ListOrder::file);
}

std::string in_vessel(const std::string& lines) {
  std::string text = least;
  return text.replace(text.find("size = [1.0, 1.0, 0.5]"), 22, lines);
}

TEST(GoodInput, ACylinderHasADiameterAndAHeight) {
  const Input in = parse(in_vessel("shape = \"cylinder\"\ndiameter = \"80 cm\"\nheight = 0.5"), "a.toml", {});
  EXPECT_EQ(in.container.shape, VesselShape::cylinder);
  EXPECT_EQ(in.container.diameter, 0.8);
  EXPECT_EQ(in.container.size, (std::vector<double>{0.8, 0.8, 0.5}));
  EXPECT_EQ(in.container.boundary, (std::vector<Boundary>{Boundary::wall, Boundary::wall}));
  EXPECT_NE(in.effective.find("shape = \"cylinder\"\ndiameter = 0.8\nheight = 0.5\n"), std::string::npos);
  EXPECT_EQ(in.effective.find("container.size"), std::string::npos);
  EXPECT_EQ(parse(in.effective, "a.toml", {}).effective, in.effective);
  const std::string by_size = in_vessel("shape = \"cylinder\"\nsize = [\"80 cm\", \"80 cm\", 0.5]");
  EXPECT_EQ(parse(by_size, "a.toml", {}).effective, in.effective);
}

/// A tetrahedron of volume 1/6, in the file's unit.
const char* const tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

TEST(GoodInput, ObstaclesAreHolesOfAMesh) {
  const std::string box = "size = [1.0, 1.0, 0.5]";
  const std::string bodies =
      "[[obstacle]]\nshape = \"sphere\"\ndiameter = \"20 cm\"\nposition = [0.3, 0.3, 0.2]\n"
      "[[obstacle]]\nshape = \"cylinder\"\naxis = \"y\"\ndiameter = 0.1\nlength = 0.9\nposition = [0.8, 0.5, 0.2]\n"
      "[[obstacle]]\nshape = \"box\"\nsize = [0.2, 0.1, \"300 mm\"]\nposition = [0.3, 0.7, 0.16]\n"
      "[[obstacle]]\nshape = \"mesh\"\nfile = \"parts/t.obj\"\nunit = \"cm\"\nposition = [0.5, 0.5, 0.4]\n";
  const NamedFiles files{.surfaces = {{"there/parts/t.obj", tetrahedron}}};
  const auto volume_without = [&](const std::string& vessel) {
    const Input in = parse(in_vessel(vessel) + bodies, "there/a.toml", {}, files);
    EXPECT_EQ(in.container.shape, VesselShape::mesh);
    EXPECT_TRUE(in.obstacles.empty());
    EXPECT_EQ(in.container.size.back(), 0.5);
    EXPECT_TRUE(parse(in.effective, "b.toml", {}).effective == in.effective) << "it needs no file";
    const double bodies_in_it =
        std::numbers::pi / 6.0 * 0.008 + 0.25 * std::numbers::pi * 0.01 * 0.9 + 0.2 * 0.1 * 0.3 + 1e-6 / 6.0;
    return in.container.mesh->volume() + bodies_in_it;
  };
  EXPECT_NEAR(volume_without(box), 0.5, 1e-12);
  const double pi = std::numbers::pi;
  EXPECT_NEAR(volume_without("shape = \"cylinder\"\ndiameter = 1.3\nheight = 0.5"), 0.125 * 1.69 * pi, 1e-12);
  EXPECT_NEAR(volume_without("shape = \"frustum\"\nbottom_diameter = 1.4\ntop_diameter = 1.3\nheight = 0.5"),
              pi / 24.0 * (1.96 + 1.82 + 1.69), 1e-12);
}

TEST(GoodInput, ComponentsGoIntoAMeshOfAFile) {
  const NamedFiles files{.surfaces = {{"there/t.obj", tetrahedron}}};
  const std::string two =
      "[mixture]\nshare_by = \"mass\"\n[[component]]\nname = \"a\"\nshare = 1\n[[component]]\nname = \"b\"\nshare = "
      "1\ndensity = 2000.0\n";
  const Input in =
      parse(in_vessel("shape = \"mesh\"\nfile = \"t.obj\"\nheight = 0.5") + two, "there/a.toml", {}, files);
  EXPECT_EQ(in.components.size(), 2U);
  EXPECT_NEAR(in.container.mesh->volume(), 1.0 / 6.0, 1e-12);
}

// Layers end at H_d there, whatever they are of; what a pack says of its scene is a scene.
TEST(GoodInput, ComponentsGoIntoAVesselThatNarrows) {
  const std::string two =
      "[mixture]\nshare_by = \"mass\"\n[[component]]\nname = \"a\"\nshare = 1\n[[component]]\nname = \"b\"\nshare = "
      "1\ndensity = 2000.0\n";
  const std::string narrowing = "shape = \"frustum\"\nbottom_diameter = 1.4\ntop_diameter = 1.0\nheight = 0.5";
  const Input in = parse(in_vessel(narrowing) + two, "a.toml", {});
  EXPECT_EQ(in.layers.region, RegionRule::container);
  EXPECT_EQ(parse(in.effective, "the scene in a pack", {}).effective, in.effective);
}

TEST(GoodInput, AMassMayHaveAUnit) {
  const std::string strata =
      "[mixture]\nshare_by = \"mass\"\n[[component]]\nname = \"a\"\nshare = 1\n[[component]]\nname = \"b\"\nshare = "
      "1\n[[stratum]]\nmass = \"150 g\"\n"
      "[[stratum]]\nmass = 0.2\n";
  const Input in = parse(in_vessel("size = [1.0, 1.0, 0.5]") + strata, "a.toml", {});
  ASSERT_EQ(in.strata.size(), 2U);
  EXPECT_EQ(in.strata[0].mass, 0.15);
}

TEST(GoodInput, WhatIsSetOfACylinderWins) {
  const std::string by_names = in_vessel("shape = \"cylinder\"\ndiameter = 0.8\nheight = 0.5");
  const std::string by_size = in_vessel("shape = \"cylinder\"\nsize = [0.8, 0.8, 0.5]");
  const auto size = [](const std::string& text, const std::string& set) {
    return parse(text, "a.toml", {.set = {set}}).container.size;
  };
  EXPECT_EQ(size(by_names, "container.size=[0.6,0.6,0.4]"), (std::vector<double>{0.6, 0.6, 0.4}));
  EXPECT_EQ(size(by_names, "container.diameter=0.6"), (std::vector<double>{0.6, 0.6, 0.5}));
  EXPECT_EQ(size(by_size, "container.height=0.4"), (std::vector<double>{0.8, 0.8, 0.4}));
  EXPECT_EQ(size(least, "container.shape=box"), (std::vector<double>{1.0, 1.0, 0.5}));
}

TEST(GoodInput, OtherVesselsHaveLengthsOfTheirOwn) {
  const Input hopper = parse(
      in_vessel("shape = \"frustum\"\nbottom_diameter = 0.3\ntop_diameter = \"80 cm\"\nheight = 0.5"), "a.toml", {});
  EXPECT_EQ(hopper.container.shape, VesselShape::frustum);
  EXPECT_EQ(hopper.container.size, (std::vector<double>{0.8, 0.8, 0.5}));
  EXPECT_EQ(container_of(hopper.container).ends, (std::array<double, 2>{0.15, 0.4}));
  EXPECT_EQ(hopper.layers.region, RegionRule::open);
  const Input heap =
      parse(in_vessel("shape = \"frustum\"\nbottom_diameter = 0.8\ntop_diameter = 0.3\nheight = 0.5"), "a.toml", {});
  EXPECT_EQ(heap.layers.region, RegionRule::container) << "it narrows";
  const Input ball = parse(in_vessel("shape = \"sphere\"\ndiameter = 0.8\nheight = 0.5"), "a.toml", {});
  EXPECT_EQ(ball.container.size, (std::vector<double>{0.8, 0.8, 0.5}));
  EXPECT_EQ(ball.layers.region, RegionRule::container);
  const Input ring =
      parse(in_vessel("shape = \"annulus\"\ndiameter = 0.8\ninner_diameter = 0.3\nheight = 0.5"), "a.toml", {});
  EXPECT_EQ(container_of(ring.container).core, 0.15);
  for (const Input& in : {hopper, heap, ball, ring})
    EXPECT_EQ(parse(in.effective, "b.toml", {}).effective, in.effective);
}

TEST(GoodInput, VesselsIn2D) {
  const Input circle =
      parse(in_vessel("dimension = 2\nshape = \"circle\"\ndiameter = 0.8\nheight = 0.5"), "a.toml", {});
  EXPECT_EQ(circle.container.size, (std::vector<double>{0.8, 0.5}));
  EXPECT_EQ(circle.container.boundary, (std::vector<Boundary>{Boundary::wall}));
  EXPECT_EQ(circle.layers.region, RegionRule::container);
  EXPECT_NEAR(container_of(circle.container).volume_between(0.0, 0.8), 0.16 * std::numbers::pi, 1e-15);
  const Input hopper =
      parse(in_vessel("dimension = 2\nshape = \"trapezium\"\nbottom_width = 0.3\ntop_width = \"80 cm\"\nheight = 0.5"),
            "a.toml", {});
  EXPECT_EQ(hopper.container.size, (std::vector<double>{0.8, 0.5}));
  EXPECT_EQ(hopper.layers.region, RegionRule::open);
  EXPECT_NEAR(container_of(hopper.container).volume_between(0.0, 0.5), 0.55 * 0.5, 1e-15);
  const Input heap =
      parse(in_vessel("dimension = 2\nshape = \"trapezium\"\nbottom_width = 0.8\ntop_width = 0.3\nheight = 0.5"),
            "a.toml", {});
  EXPECT_EQ(heap.layers.region, RegionRule::container) << "it narrows";
  // Clockwise, and not at the origin.
  const Input rhomb =
      parse(in_vessel("dimension = 2\nshape = \"polygon\"\npolygon = [[1.0, 2.5], [1.5, 2.0], [1.0, 1.5], "
                      "[0.5, 2.0]]\nheight = 0.75"),
            "a.toml", {});
  EXPECT_EQ(rhomb.container.size, (std::vector<double>{1.0, 0.75}));
  EXPECT_EQ(rhomb.layers.region, RegionRule::container);
  EXPECT_NEAR(container_of(rhomb.container).volume_between(0.0, 1.0), 0.5, 1e-15);
  EXPECT_NEAR(container_of(rhomb.container).from_sides({0.5, 0.5, 0.0}), 0.5 * std::sqrt(0.5), 1e-15);
  for (const Input& in : {circle, hopper, heap, rhomb})
    EXPECT_EQ(parse(in.effective, "b.toml", {}).effective, in.effective);
}

TEST(GoodInput, InsertionAloneAsksForLittle) {
  const std::string text =
      "[container]\nsize = [1.0, 1.0, 0.5]\n[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e8\n"
      "poisson_ratio = 0.25\nradius = { distribution = \"equal\", value = 0.02 }\n[layers]\nduration = 0\n";
  const Input by_fraction = parse(text + "fraction = 0.3\n", "a.toml", {});
  EXPECT_TRUE(insertion_alone(by_fraction));
  EXPECT_EQ(by_fraction.layers.thickness, 0.5) << "the whole container";
  EXPECT_EQ(by_fraction.jamming.gravity, 0.0);
  const Input by_count = parse(text, "a.toml", {{"particles.count=100", "fidelity=balanced"}});
  EXPECT_EQ(by_count.particles.count, 100);
  for (const Input& in : {by_fraction, by_count}) EXPECT_EQ(parse(in.effective, "b.toml", {}).effective, in.effective);
}

TEST(GoodInput, UnitsAsPeopleWriteThem) {
  EXPECT_EQ(tables::parse_scalar("7 \xc2\xb5m", length).value, 7e-6);  // the micro sign
  EXPECT_EQ(tables::parse_scalar("7\xce\xbcm", length).value, 7e-6);   // the letter mu
  EXPECT_EQ(tables::parse_scalar("2650 kg/m^3", density).value, 2650.0);
  EXPECT_EQ(tables::parse_scalar("2.65 g/cm\xc2\xb3", density).value, 2650.0);
  EXPECT_EQ(tables::parse_scalar("9.81 m/s^2", acceleration).value, 9.81);
  EXPECT_EQ(tables::parse_scalar("9.81 m/s\xc2\xb2", acceleration).value, 9.81);
  EXPECT_EQ(tables::parse_scalar("50 N/mm^2", pressure).value, 5e7);
  EXPECT_EQ(tables::parse_scalar("5 N\xc2\xb7s/m", drag_factor).value, 5.0);
  EXPECT_FALSE(tables::parse_scalar("5 ^m", density).value);
}

TEST(GoodInput, KeptPartOfACurve) {
  Radius radius;
  radius.diameter_curve = {{0.001, 0.0}, {0.01, 50.0}, {0.1, 100.0}};
  radius.keep_percent = {25.0, 75.0};
  const Curve kept = kept_curve(radius);
  ASSERT_EQ(kept.size(), 3U);
  EXPECT_NEAR(kept[0][0], 0.001 * std::sqrt(10.0), 1e-17);
  EXPECT_EQ(kept[1], (std::array<double, 2>{0.01, 50.0}));
  EXPECT_NEAR(kept[2][0], 0.01 * std::sqrt(10.0), 1e-16);
  radius.interpolation = Interpolation::linear;
  radius.keep_percent = {0.0, 80.0};
  EXPECT_EQ(kept_curve(radius), (Curve{{0.001, 0.0}, {0.01, 62.5}, {0.01 + 0.6 * (0.1 - 0.01), 100.0}}));
  radius.keep_percent = {50.0, 100.0};
  EXPECT_EQ(kept_curve(radius), (Curve{{0.01, 0.0}, {0.1, 100.0}}));
}

TEST(GoodInput, OverridesWin) {
  const Input in = parse(least, "a.toml",
                         {{"seed=7", "layers.thickness=120 mm", "layers.thickness=0.15", " contact . wall = material ",
                           "container.boundary=[\"periodic\", \"wall\"]", "petsc.options=-log_view"}});
  EXPECT_EQ(in.seed, 7U);
  EXPECT_EQ(in.layers.thickness, 0.15);
  EXPECT_EQ(in.contact.wall, WallStiffness::material);
  EXPECT_EQ(in.container.boundary.front(), Boundary::periodic);
  EXPECT_EQ(in.petsc.options, "-log_view");
}

TEST(GoodInput, EffectiveInputIsAFixedPointAndHidesNothing) {
  for (const std::string& text : {least, full}) {
    const Input in = parse(text, "a.toml", {});
    EXPECT_EQ(parse(in.effective, "a.toml", {}).effective, in.effective);
  }
  const std::string effective = parse(full, "a.toml", {}).effective;
  for (const Key& key : keys()) {
    if (Input in = parse(full, "a.toml", {}); !key.applies(in)) continue;  // of another size distribution
    std::string line(key.path.substr(key.path.rfind('.') + 1));
    line.insert(0, 1, '\n').append(" = ");
    EXPECT_NE(("\n" + effective).find(line), std::string::npos) << key.path;
  }
}

TEST(GoodInput, EffectiveInputIsOfTheSameScene) {
  const Input in = parse(parse(full, "a.toml", {}).effective, "a.toml", {});
  EXPECT_EQ(in.particles.density, 2500.0);
  EXPECT_EQ(in.layers.spin, (Vec3{0.0, 0.0, 3.0}));
  EXPECT_EQ(in.petsc.options, "-log_view -implicit_snes_rtol 1e-9");
  EXPECT_EQ(in.near_field->alpha2, 2.5e-9);
}

TEST(Units, AreExact) {
  const auto metres = [](const char* text) { return tables::parse_scalar(text, length).value; };
  EXPECT_EQ(metres("20 mm"), 0.02);
  EXPECT_EQ(metres("0.3mm"), 0.0003);  // 0.3 * 1e-3 is another double
  EXPECT_EQ(metres(" 12.3e-1 \t um "), 1.23e-6);
  EXPECT_EQ(metres("1E+2 nm"), 1e-7);
  EXPECT_EQ(metres("7 km"), 7000.0);
  EXPECT_EQ(metres("-1 cm"), -0.01);
  EXPECT_EQ(tables::parse_scalar("1 g/cm3", density).value, 1000.0);
  EXPECT_EQ(tables::parse_scalar("48 GPa", pressure).value, 48e9);
  EXPECT_EQ(tables::parse_scalar("5 mN s/m", drag_factor).value, 0.005);
  for (const char* wrong :
       {"", "mm", "1", "1 MM", "1 m m", "nan m", "inf m", "0x1p3 m", "1e m", "1e99999 m", "--1 m"}) {
    EXPECT_FALSE(metres(wrong).has_value()) << wrong;
  }
}

TEST(Rhythm, OfCheckpoints) {
  using tables::rhythm_of;
  EXPECT_EQ(rhythm_of("10min")->seconds, 600.0);
  EXPECT_EQ(rhythm_of("90 s")->seconds, 90.0);
  EXPECT_EQ(rhythm_of("1.5h")->seconds, 5400.0);
  EXPECT_EQ(rhythm_of("5000 steps")->steps, 5000);
  EXPECT_EQ(rhythm_of("1 step")->steps, 1);
  EXPECT_EQ(rhythm_of("off")->steps, 0);
  EXPECT_EQ(rhythm_of("off")->seconds, 0.0);
  for (const char* wrong : {"", "10", "0 s", "-1 s", "0 steps", "1.5 steps", "10 m", "min", "1e3 s", "nan s",
                            "99999999999999999999 steps", "9223372036854775807 steps", "10  min", "OFF", "1..5 h"}) {
    EXPECT_FALSE(rhythm_of(wrong).has_value()) << wrong;
  }
}

TEST(KeyTable, IsConsistent) {
  for (const Key& key : keys()) {
    EXPECT_EQ(find_key(key.path), &key) << "declared twice: " << key.path;
    EXPECT_TRUE(key.doc.ends_with('.')) << key.path;
    for (const std::string_view word : choices(key)) EXPECT_NE(wanted(key).find(word), std::string::npos) << key.path;
  }
}

/// Lines "# key = value" of the starter without their marks.
std::string all_in(const std::string& text) {
  std::istringstream lines(text);
  std::string out;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t name_end = line.find_first_not_of("abcdefghijklmnopqrstuvwxyz_0123456789", 2);
    const bool key = line.starts_with("# ") && name_end > 2 && name_end != std::string::npos &&
                     line.compare(name_end, 3, " = ") == 0 && line.find("# only if") == std::string::npos;
    out += (key ? line.substr(2) : line) + "\n";
  }
  return out;
}

TEST(Starter, IsAScene) {
  for (const int dimension : {2, 3}) {
    const std::string text = cli::starter(dimension);
    const Input in = parse(text, "scene.toml", {});
    EXPECT_EQ(in.container.dimension, dimension);
    EXPECT_EQ(parse(all_in(text), "scene.toml", {}).effective, in.effective) << "what is commented out is the default";
    for (const Key& key : keys()) {
      const std::string name(key.path.substr(key.path.rfind('.') + 1));
      EXPECT_NE(text.find(name + " = "), std::string::npos) << key.path;
    }
  }
}

}  // namespace
}  // namespace packmpi::input
