// The rows of doc/extremes.md: scenes at the ends of what a scene file can say. Each ends right or in a clear error.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "input/read.hpp"
#include "run/make_pack.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Set = std::vector<std::string>;

// A few dozen spheres, settled in a second of simulated time.
const char* const brick = R"(
[container]
size = [0.2, 0.2, 0.05]
[particles]
density = 1000.0
youngs_modulus = 1e7
poisson_ratio = 0.25
radius = { distribution = "equal", value = 0.02 }
[layers]
thickness = 0.2
fraction = 0.15
duration = 0.5
maximum = 1
[jamming]
gravity = 5.0
[contact]
damping_ratio = 0.3
)";

class Extremes : public ::testing::Test {
 protected:
  comm::Comm comm_{MPI_COMM_WORLD};

  output::RunRecord pack(const Set& set) {
    Options options;
    options.folder =
        comm_.broadcast(0, (fs::temp_directory_path() / ("packmpi_extremes_" + std::to_string(::getpid()))).string());
    options.force = true;
    options.verbosity = log::Verbosity::quiet;
    output::RunRecord record = make_pack(comm_, scene::build(input::parse(brick, "brick.toml", {set})), options);
    comm_.barrier();
    if (comm_.rank() == 0) fs::remove_all(options.folder);
    comm_.barrier();
    return record;
  }
  // The scene ends right: nobody lost, outside or pressed too far.
  output::RunRecord sound(const Set& set) {
    output::RunRecord record = pack(set);
    EXPECT_EQ(record.audit.found, record.audit.expected);
    EXPECT_EQ(record.audit.non_finite + record.audit.outside, 0);
    EXPECT_LT(std::max(record.audit.worst_overlap, record.audit.worst_wall_penetration), 0.5);
    return record;
  }
  // The words the scene ends in.
  std::string refused(const Set& set, ExitCode code = ExitCode::bad_input) {
    try {
      (void)pack(set);
      ADD_FAILURE() << "it ended well";
      return "";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code) << error.what();
      return error.what();
    }
  }
};

TEST_F(Extremes, ModulusOf1e12) {
  const auto record = sound({"particles.youngs_modulus=1e12", "layers.duration=0.02", "layers.velocity=[0, 0, -5]"});
  EXPECT_LT(record.audit.worst_overlap, 1e-2);
}

TEST_F(Extremes, ModulusOf1e4) {
  EXPECT_THAT(refused({"particles.youngs_modulus=1e4", "jamming.gravity=500", "dynamics.time_step=1e-4"},
                      ExitCode::numerical_failure),
              HasSubstr("of the smaller radius, beyond 0.5 of it"));
  (void)sound({"particles.youngs_modulus=1e4", "jamming.gravity=0.05", "layers.duration=4"});
}

TEST_F(Extremes, RadiusOfAMicrometre) {
  const auto record = sound({"container.size=[1e-5, 1e-5, 2.5e-6]", "particles.radius.value=1e-6",
                             "layers.thickness=1e-5", "layers.duration=2e-3"});
  EXPECT_LT(record.top, 1e-5);
}

TEST_F(Extremes, RadiusOfAKilometre) {
  const auto record = sound({"container.size=[1e4, 1e4, 2.5e3]", "particles.radius.value=1e3", "layers.thickness=1e4",
                             "layers.duration=120", "particles.youngs_modulus=1e10", "output.log_every=1"});
  EXPECT_NEAR(record.floor_force, record.weight, 0.2 * record.weight);
}

TEST_F(Extremes, OneParticleRestsOnItsHertzOverlap) {  // and so few that none is asked for: one is the least
  const auto record = sound({"layers.fraction=1e-5", "layers.duration=2", "drag.coefficient=0.05"});
  EXPECT_EQ(record.particles, 1);
  EXPECT_NEAR(record.floor_force, record.weight, 1e-3 * record.weight);
}

TEST_F(Extremes, DampingFromNoneToFiveTimesCritical) {
  (void)sound({"contact.damping_ratio=0"});
  (void)sound({"contact.damping_ratio=1"});
  (void)sound({"contact.damping_ratio=5"});  // "auto": the limit is lower beyond 1
  EXPECT_THAT(refused({"contact.damping_ratio=5", "dynamics.time_step=1e-3"}), HasSubstr("damping_ratio 5"));
}

TEST_F(Extremes, FrictionOfNoneAndTwo) {
  (void)sound({"contact.friction=0"});
  (void)sound({"contact.friction=2"});
}

TEST_F(Extremes, WithoutGravityNothingSettlesAndLayersEnd) {
  const auto record = sound({"jamming.gravity=0", "dynamics.time_step=1e-4", "layers.duration=0.01", "layers.maximum=0",
                             "dynamics.stop=settled"});
  EXPECT_TRUE(record.reached);
  EXPECT_EQ(record.kinetic_energy, 0.0);
  EXPECT_EQ(record.layers.front().stop_reason, "duration");
  EXPECT_THAT(refused({"jamming.gravity=0"}), HasSubstr("\"auto\" needs gravity or a speed at insertion"));
}

TEST_F(Extremes, StepsFromATenthToAHundredTimesTheLimit) {
  const double limit = scene::build(input::parse(brick, "brick.toml", {})).time_step;
  const auto step = [&](double factor) { return "dynamics.time_step=" + std::to_string(factor * limit); };
  (void)sound({"dynamics.time_step=" + fmt::format("{:.17g}", 0.1 * limit), "layers.duration=0.1"});
  (void)sound({"dynamics.time_step=" + fmt::format("{:.17g}", 0.999 * limit)});
  for (const double factor : {1.1, 10.0, 100.0}) EXPECT_THAT(refused({step(factor)}), HasSubstr("limit of eq. (23)"));
}

TEST_F(Extremes, SpeedsFarAboveTheAssumptionOfTheStep) {
  EXPECT_THAT(refused({"drag.coefficient=5", "drag.fluid_velocity=[0, 0, -300]"}, ExitCode::numerical_failure),
              ::testing::AnyOf(HasSubstr("overlaps another or a wall"), HasSubstr("faster than"), HasSubstr("left")));
}

TEST_F(Extremes, SaturationAndSizesThatCannotFit) {
  EXPECT_THAT(refused({"layers.fraction=0.5", "layers.attempts=200"}), HasSubstr("random sequential addition placed"));
  EXPECT_THAT(refused({"layers.fraction=0.9"}), HasSubstr("cannot be reached by random insertion"));
  EXPECT_THAT(refused({"particles.radius.value=0.11"}), HasSubstr("more than container.size"));
}

TEST_F(Extremes, PeriodicAxisOfTheLeastLegalWidth) {
  (void)sound({"container.boundary=[\"periodic\", \"wall\"]", "container.size=[0.1261, 0.2, 0.05]"});
  EXPECT_THAT(refused({"container.boundary=[\"periodic\", \"wall\"]", "container.size=[0.1259, 0.2, 0.05]"}),
              HasSubstr("a periodic axis must be at least 0.126 m"));
}

TEST_F(Extremes, NearFieldBeyondTheRangeOfNumbers) {
  EXPECT_THAT(refused({"near_field.alpha2=1", "near_field.beta2=300", "near_field.cutoff=0.06"}),
              HasSubstr("near_field: the force at a distance of 0.02 m is beyond the range of numbers"));
}

// A line for scripts: how many rows ended as the page says.
class Count : public ::testing::EmptyTestEventListener {
  void OnTestProgramEnd(const ::testing::UnitTest& all) override {
    std::printf("extremes passed: %d of %d\n", all.successful_test_count(), all.test_to_run_count());
  }
};
const bool counted = [] {
  ::testing::UnitTest::GetInstance()->listeners().Append(new Count);
  return true;
}();

}  // namespace
}  // namespace packmpi::run
