// States that must not be: each is found in time, the same words come on all ranks and on any number of them, and the
// last valid checkpoint stays.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "input/read.hpp"
#include "pack/checkpoint.hpp"
#include "run/bed.hpp"
#include "run/make_pack.hpp"
#include "support/scenes.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;

// Spheres in mid-air, in a row through all ranks, apart by three radii; number 7 is the one to be spoilt.
class Guards : public ::testing::Test {
 protected:
  comm::Comm comm_{MPI_COMM_WORLD};
  scene::Scene scene_ = scene::build(input());
  Bed bed_{comm_, scene_};

  static input::Input input() {
    input::Input in = test::small_input(3, 1.0, 0.02);
    in.dynamics.time_step = 5e-5;
    return in;
  }
  void SetUp() override {
    for (GlobalId id = 0; id < 16; ++id) {
      const Vec3 x{0.05 + 0.06 * static_cast<double>(id), 0.5, 0.5};
      if (bed_.ownership.owner(bed_.ownership.grid().column(x)) == comm_.rank()) bed_.store.add(id, x, 0.02, {}, {});
    }
    bed_.progress.count = 16;
    bed_.neighborhood.rebuild(bed_.store);
  }
  // The record of a particle, if it is here.
  double* record(GlobalId id) {
    for (LocalIndex i = 0; i < bed_.store.owned(); ++i) {
      if (bed_.store.ids()[static_cast<std::size_t>(i)] == id) return bed_.store.record(i);
    }
    return nullptr;
  }
  // The words that end the run, rank 0's, and the steps made until then. Fails if ranks differ or nothing is found.
  std::string words(std::int64_t most_steps) {
    try {
      bed_.stepper.advance(bed_.store, bed_.neighborhood, most_steps, {.layer = 3, .step = 1000, .time = 2.0});
      ADD_FAILURE() << "not found in " << most_steps << " steps";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::numerical_failure);
      std::string mine = error.what();
      EXPECT_EQ(mine, comm_.broadcast(0, mine));
      return mine;
    }
    return "";
  }
};

TEST_F(Guards, NotFiniteIsFoundInTheStep) {
  if (double* r = record(7)) r[2] = std::nan("");
  EXPECT_THAT(words(1),
              ::testing::HasSubstr("layer 3, step 1001, 2.00005 s: particle 7 has numbers that are not finite"));
}

TEST_F(Guards, ASpeedBeyondTheScenesOwnIsFoundInTheStep) {
  const double bound = scene_.speed_bound;  // 16 sqrt(2 g h), h the height of all layers there may be
  EXPECT_NEAR(bound, 16.0 * std::sqrt(2.0 * 2.0 * 0.5 * std::ceil(1.0 / (0.2 * 0.5) + 2.0)), 1e-9);
  if (double* r = record(7)) r[4] = 0.9 * bound;
  bed_.stepper.advance(bed_.store, bed_.neighborhood, 1);
  if (double* r = record(7)) r[4] = 1.1 * bound;
  const std::string said = words(1);
  EXPECT_THAT(said,
              ::testing::HasSubstr("particle 7 is faster than this scene can make it: 86.2 m/s, beyond 78.4 m/s"));
  EXPECT_THAT(said,
              ::testing::HasSubstr("it touches nothing; use dynamics.time_step = 2.5e-05 s or less (eq. (23) gives "));
  EXPECT_THAT(said, ::testing::EndsWith(" s at 86.2 m/s)"));
}

TEST_F(Guards, AStepOfHalfARadiusIsTooFar) {
  scene::Stage stage = scene_.last();
  stage.time_step = 1e-3;
  bed_.stepper.use(stage);
  if (double* r = record(7)) r[4] = 10.1;
  EXPECT_THAT(words(1),
              ::testing::HasSubstr("particle 7 is faster than this scene can make it: 10.1 m/s, beyond 10 m/s"));
}

TEST_F(Guards, ADeepOverlapIsFoundByItsForceAndTheNeighboursAreNamed) {
  if (double* r = record(7)) r[0] += 0.033;  // 8 is 0.06 away: 0.013 of 0.02 remain, and only they are listed
  bed_.neighborhood.rebuild(bed_.store);
  const std::string said = words(100);
  EXPECT_THAT(said,
              ::testing::MatchesRegex(
                  "layer 3, step 10.., 2.* s: particle 7 overlaps another or a wall by 0.[56].* of the smaller "
                  "radius, beyond 0.5 of it: position \\(0.5.*\\) m, velocity \\(.*\\) m/s, radius 0.02 m, on rank "
                  "[0-9]; it touches 8 \\(overlap 0.[56].* r\\); use dynamics.time_step = .* s or less.*"));
}

TEST_F(Guards, CoincidentCentresHaveNoNormalButAreFound) {
  if (double* r = record(7)) r[0] = 0.05 + 0.06 * 8;
  bed_.neighborhood.rebuild(bed_.store);
  EXPECT_THAT(words(1), ::testing::HasSubstr("it touches 8 (overlap 2 r)"));
}

TEST_F(Guards, AForceBeyondTheSumsIsFoundInTheStep) {
  if (double* r = record(7)) r[0] += 0.0201;
  if (double* r = record(8)) r[4] = -70.0;  // damping at that speed
  scene_.force_quantum = 0x1p-50;           // as if the scene were a gentle one
  bed_.neighborhood.rebuild(bed_.store);
  EXPECT_THAT(words(1), ::testing::HasSubstr("a force is beyond 1 N, the range of the sums; the fastest particle, 8:"));
}

TEST_F(Guards, OutsideIsFoundBeforeAMarginIsUsedUp) {
  if (double* r = record(7)) {
    r[1] = -0.021;  // no wall holds what is this far out
    r[5] = -1.0;
  }
  const auto most = static_cast<std::int64_t>(scene_.most_margin / (1.0 * 5e-5)) + 2;
  EXPECT_THAT(words(most), ::testing::HasSubstr("particle 7 left the container: position (0.47, -0.02"));
}

TEST_F(Guards, CheckFindsAllOfThemAtOnce) {
  bed_.check();
  if (double* r = record(7)) r[1] = -0.021;
  EXPECT_THROW(bed_.check(), Error);
}

// Falls for a while, then is far too soft for its impact.
const char* const soft = R"(
[container]
size = [0.2, 0.2, 0.1]
[particles]
density = 1000.0
youngs_modulus = 1e4
poisson_ratio = 0.25
radius = { distribution = "equal", value = 0.02 }
[layers]
thickness = 0.1
fraction = 0.05
duration = 1.0
velocity = [0.0, 0.0, -10.0]
[jamming]
gravity = 1.0
[dynamics]
time_step = 1e-5
[checkpoint]
every = "50 steps"
)";

TEST(GuardedRun, LeavesTheLastValidCheckpointAndIsNotContinuedAsAnotherScene) {
  const comm::Comm comm(MPI_COMM_WORLD);
  Options options;
  options.folder =
      comm.broadcast(0, (fs::temp_directory_path() / ("packmpi_guards_" + std::to_string(::getpid()))).string());
  options.verbosity = log::Verbosity::quiet;
  const auto ends = [&](const std::vector<std::string>& set) {
    try {
      const report::RunRecord record = make_pack(comm, scene::build(input::parse(soft, "soft.toml", {set})), options);
      ADD_FAILURE() << "a pack of " << record.particles;
    } catch (const Error& error) {
      return std::pair{error.code(), std::string(error.what())};
    }
    return std::pair{ExitCode::done, std::string()};
  };
  const auto first = ends({});
  EXPECT_EQ(first.first, ExitCode::numerical_failure);
  std::int64_t failed = 0;
  ASSERT_EQ(std::sscanf(first.second.c_str(), "layer 1, step %ld,", &failed), 1) << first.second;
  std::int64_t newest = 0;
  for (const char* slot : {"soft.ckpt.A.hdf", "soft.ckpt.B.hdf"}) {
    newest = std::max(newest, pack::read_state((fs::path(options.folder) / slot).string()).progress.steps);
  }
  EXPECT_GT(newest, 50);
  EXPECT_LT(newest, failed);
  EXPECT_GE(newest, failed - 50);
  EXPECT_FALSE(fs::exists(fs::path(options.folder) / "soft.hdf"));

  options.restart = "auto";  // the same scene fails again, at the same step, in the same words
  EXPECT_EQ(ends({}), first);
  const auto smaller = ends({"dynamics.time_step=5e-6"});  // and with another step it is another scene
  EXPECT_EQ(smaller.first, ExitCode::bad_checkpoint);
  EXPECT_THAT(smaller.second, ::testing::HasSubstr("dynamics.time_step: 1e-05 before, 5e-06 now"));
  comm.barrier();
  if (comm.rank() == 0) fs::remove_all(options.folder);
}

}  // namespace
}  // namespace packmpi::run
