// The rows of doc/extremes.md: scenes at the ends of what a scene file can say. Each ends right or in a clear error.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <numbers>
#include <tuple>

#include "input/read.hpp"
#include "observe/measure.hpp"
#include "pack/pack.hpp"
#include "rsa/insert.hpp"
#include "run/make_pack.hpp"
#include "support/placed_bed.hpp"

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
[rest]
wait = 0.0
)";

class Extremes : public ::testing::Test {
 protected:
  comm::Comm comm_{MPI_COMM_WORLD};
  pack::PackRows rows_;  // of the last pack

  report::RunRecord pack(const Set& set) {
    Options options;
    options.folder =
        comm_.broadcast(0, (fs::temp_directory_path() / ("packmpi_extremes_" + std::to_string(::getpid()))).string());
    options.force = true;
    options.verbosity = log::Verbosity::quiet;
    report::RunRecord record = make_pack(comm_, scene::build(input::parse(brick, "brick.toml", {set})), options);
    rows_ = pack::read_pack(options.folder + "/brick.hdf");
    comm_.barrier();
    if (comm_.rank() == 0) fs::remove_all(options.folder);
    comm_.barrier();
    return record;
  }
  // The scene ends right: nobody lost, outside or pressed too far.
  report::RunRecord valid(const Set& set) {
    report::RunRecord record = pack(set);
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

constexpr double brick_mass = 1000.0 * 4.0 / 3.0 * std::numbers::pi * 0.02 * 0.02 * 0.02;  // [kg] of a particle

// Penetration / radius of a particle at rest on the floor: E / (1 - nu^2) 4/3 sqrt(r d) d = m g.
double resting(double gravity) {
  const double stiffness = 4.0 / 3.0 * 1e7 / (1.0 - 0.25 * 0.25);
  return std::pow(brick_mass * gravity / (stiffness * 0.02 * 0.02), 2.0 / 3.0);
}

TEST_F(Extremes, ModulusOf1e12) {
  const auto record = valid({"particles.youngs_modulus=1e12", "layers.duration=0.02", "layers.velocity=[0, 0, -5]"});
  EXPECT_LT(record.audit.worst_overlap, 1e-2);
}

TEST_F(Extremes, ModulusOf1e4) {
  EXPECT_THAT(refused({"particles.youngs_modulus=1e4", "layers.velocity=[0, 0, -5]", "dynamics.time_step=1e-4"},
                      ExitCode::numerical_failure),
              HasSubstr("of the smaller radius, beyond 0.5 of it"));
  EXPECT_THAT(refused({"particles.youngs_modulus=1e4", "jamming.gravity=500"}),
              HasSubstr("particles.youngs_modulus: 10000 Pa is too soft for this bed"));
  (void)valid({"particles.youngs_modulus=1e4", "jamming.gravity=0.05", "layers.duration=4"});
}

TEST_F(Extremes, RadiusOfAMicrometre) {
  const auto record = valid({"container.size=[1e-5, 1e-5, 2.5e-6]", "particles.radius.value=1e-6",
                             "layers.thickness=1e-5", "layers.duration=2e-3"});
  EXPECT_LT(record.top, 1e-5);
}

TEST_F(Extremes, RadiusOfAKilometre) {
  const auto record = valid({"container.size=[1e4, 1e4, 2.5e3]", "particles.radius.value=1e3", "layers.thickness=1e4",
                             "layers.duration=120", "particles.youngs_modulus=1e10", "output.log_every=1"});
  EXPECT_NEAR(record.floor_force, record.weight, 0.2 * record.weight);
}

TEST_F(Extremes, OneParticleRestsOnItsHertzOverlap) {  // and so few that none is asked for: one is the least
  const auto record = valid({"layers.fraction=1e-5", "layers.duration=2", "drag.coefficient=0.05"});
  EXPECT_EQ(record.particles, 1);
  EXPECT_NEAR(record.floor_force, record.weight, 1e-3 * record.weight);
  EXPECT_NEAR(record.audit.worst_wall_penetration, resting(5.0), 1e-3 * resting(5.0));
}

TEST_F(Extremes, AnEmptyLayer) {
  EXPECT_THAT(refused({"layers.fraction=0"}), HasSubstr("layers.fraction"));
  EXPECT_THAT(refused({"layers.thickness=0"}), HasSubstr("layers.thickness"));
  test::Bench bench(comm_, test::small_input(3, 1.0, 0.02));  // nobody is there, on any rank
  bench.start();
  bench.step(200);
  const Bed& bed = bench.bed();
  const auto contacts =
      observe::contacts(comm_, bed.store, bench.scene(), bed.neighborhood.pairs(), bed.neighborhood.walls());
  EXPECT_EQ(contacts.pairs, 0);
  EXPECT_EQ(contacts.coordination + contacts.mean_overlap, 0.0);
  EXPECT_EQ(bed.height(), 0.0);
  EXPECT_EQ(observe::motion(comm_, bed.store, bench.scene()).kinetic_energy, 0.0);
  EXPECT_EQ(observe::density(comm_, bed.store, bench.scene(), bed.bulk()).phi, 0.0);
}

// Two that overlap and fall side by side: mirror images for good, in heights and speeds to the last bit.
TEST_F(Extremes, TwoParticlesAtTheSameHeight) {
  test::Bench bench(comm_, test::small_input(3, 1.0, 0.02));
  bench.place({0.4805, 0.5, 0.03}, 0.02);
  bench.place({0.5195, 0.5, 0.03}, 0.02);
  bench.start();
  for (int k = 0; k < 20; ++k) {
    bench.step(500);
    const auto a = bench.state(0), b = bench.state(1);
    ASSERT_EQ(a.x[2], b.x[2]);
    ASSERT_EQ(a.v[2], b.v[2]);
    ASSERT_EQ(a.v[0], -b.v[0]);
    ASSERT_EQ(a.v[1], 0.0);
  }
  EXPECT_LT(bench.state(0).v[0], 0.0);
}

TEST_F(Extremes, RatiosOfRadiiFromTwoToFifty) {
  for (const double ratio : {2.0, 5.0, 10.0, 20.0, 50.0}) {
    const auto record = valid({fmt::format("particles.radius={{ distribution = \"bidisperse\", small = {:.17g}, large "
                                           "= 0.02, large_share = 0.5, weighting = \"number\" }}",
                                           0.02 / ratio),
                               "layers.fraction=0.05", "layers.duration=0.1", "layers.velocity=[0, 0, -1]"});
    EXPECT_EQ(record.max_radius, 0.02);
    EXPECT_EQ(record.min_radius, 0.02 / ratio);
  }
}

// A million radii wide, and as periodic, flat and high: no memory goes to empty ground.
TEST_F(Extremes, BoxOfAMillionRadii) {
  const Set wide{"container.size=[2e4, 2e4, 0.05]", "layers.fraction=1e-11", "layers.duration=2",
                 "drag.coefficient=0.05"};
  const auto expect_rest = [&](const report::RunRecord& record) {  // each alone on the floor
    EXPECT_GT(record.particles, 20);
    EXPECT_NEAR(record.floor_force, record.weight, 1e-3 * record.weight);
    EXPECT_NEAR(record.audit.worst_wall_penetration, resting(5.0), 1e-3 * resting(5.0));
    EXPECT_NEAR(record.height / static_cast<double>(record.particles), 0.04 / (5e5 * 5e5), 1e-3 * 0.04 / (5e5 * 5e5));
  };
  expect_rest(valid(wide));
  Set periodic = wide;
  periodic.emplace_back("container.boundary=[\"periodic\", \"periodic\"]");
  expect_rest(valid(periodic));
  const auto flat = valid({"container.dimension=2", "container.size=[2e4, 0.05]", "container.boundary=[\"wall\"]",
                           "layers.fraction=1e-5", "layers.duration=0.5"});
  EXPECT_GT(flat.particles, 20);
  EXPECT_THAT(refused({"container.size=[3e7, 0.2, 0.05]", "layers.fraction=1e-10"}),
              HasSubstr("times the smallest radius; beyond 1e+09 positions could not tell overlaps"));

  input::Input in = test::small_input(3, 2e4, 0.02);
  in.layers.fraction = 1e-14;
  in.layers.maximum = 1;
  in.dynamics.time_step = 1e-6;
  test::Bench bench(comm_, in);  // a pair in each corner of a cube, and in its middle
  for (const double x : {0.02, 1e4, 2e4 - 0.06}) {
    for (const double z : {0.02, 1e4, 2e4 - 0.02}) {
      bench.place({x, x, z}, 0.02);
      bench.place({x + 0.036, x, z}, 0.02);
    }
  }
  bench.start();
  bench.step(10);
  EXPECT_EQ(observe::contacts(comm_, bench.bed().store, bench.scene(), bench.neighborhood().pairs(),
                              bench.neighborhood().walls())
                .pairs,
            9);
}

TEST_F(Extremes, DampingFromNoneToFiveTimesCritical) {
  (void)valid({"contact.damping_ratio=0"});
  (void)valid({"contact.damping_ratio=1"});
  (void)valid({"contact.damping_ratio=5"});  // "auto": the limit is lower beyond 1
  EXPECT_THAT(refused({"contact.damping_ratio=5", "dynamics.time_step=1e-3"}), HasSubstr("damping_ratio 5"));

  // Head on at +-1 m/s, until long after they parted. With s = overlap^{5/4} the law is that of a linear oscillator
  // whose damping ratio is zeta = sqrt(6/5) xi. They part when the force is none, as nothing pulls: for zeta > 1, with
  // roots of ratio q < 1, at the speed q^{(1 + q) / (1 - q)}.
  const auto speed_after = [&](double xi) {
    input::Input in = test::vacuum(3, 1.0, 0.02, 5e-7, 1.0);
    in.contact.damping_ratio = xi;
    test::Bench bench(comm_, in);
    bench.place({0.48, 0.5, 0.5}, 0.02, {1.0, 0.0, 0.0});
    bench.place({0.52, 0.5, 0.5}, 0.02, {-1.0, 0.0, 0.0});
    bench.start();
    bench.step(40000);
    return bench.state(1).v[0];
  };
  const auto expected = [](double xi) {
    const double zeta = std::sqrt(1.2) * xi, root = std::sqrt(zeta * zeta - 1.0), q = (zeta - root) / (zeta + root);
    return std::pow(q, (1.0 + q) / (1.0 - q));
  };
  EXPECT_NEAR(speed_after(0.0), 1.0, 1e-3);
  for (const double xi : {1.0, 5.0}) EXPECT_NEAR(speed_after(xi) / expected(xi), 1.0, 1e-2) << xi;
}

TEST_F(Extremes, FrictionOfNoneAndTwo) {
  (void)valid({"contact.friction=0"});
  (void)valid({"contact.friction=2"});

  // Without spin a particle slides v^2 / (2 mu g) on the floor, or for ever.
  const auto slide = [&](double mu, double seconds) {
    input::Input in = test::small_input(3, 1.0, 0.02);
    in.particles.youngs_modulus = 1e7;
    in.jamming.gravity = 5.0;
    in.contact.wall_friction = mu;
    in.dynamics.rotation = false;
    in.dynamics.time_step = 5e-5;
    test::Bench bench(comm_, in);
    bench.place({0.2, 0.5, 0.02 * (1.0 - resting(5.0))}, 0.02, {1.0, 0.0, 0.0});
    bench.start();
    bench.step(std::llround(seconds / 5e-5));
    return bench.state(0);
  };
  EXPECT_NEAR(slide(0.0, 0.5).x[0], 0.7, 1e-9);
  EXPECT_EQ(slide(0.0, 0.5).v[0], 1.0);
  EXPECT_NEAR(slide(2.0, 0.5).x[0] - 0.2, 1.0 / (2.0 * 2.0 * 5.0), 1e-4);
  EXPECT_LT(std::abs(slide(2.0, 0.5).v[0]), 1e-12);
}

TEST_F(Extremes, SlipExactlyZero) {  // has no direction
  for (const Set& law : {Set{"contact.regularisation=stop"}, Set{"contact.regularisation=none"},
                         Set{"contact.regularisation=viscous", "contact.slip_time=1e-2"}, Set{"dynamics.theta=1"}}) {
    Set one{"layers.fraction=1e-5", "contact.friction=0.5"};
    one.insert(one.end(), law.begin(), law.end());
    (void)valid(one);
    ASSERT_EQ(rows_.id.size(), 1U);
    EXPECT_EQ(rows_.velocity[0][0], 0.0) << law[0];
    EXPECT_EQ(rows_.velocity[0][1], 0.0) << law[0];
    EXPECT_EQ(rows_.spin[0], Vec3{}) << law[0];
  }
  input::Input in = test::small_input(3, 1.0, 0.02);
  in.contact.friction = 2.0;
  test::Bench bench(comm_, in);  // one falls upon the top of another
  bench.place({0.5, 0.5, 0.02}, 0.02);
  bench.place({0.5, 0.5, 0.0605}, 0.02);
  bench.start();
  bench.step(20000);
  for (const GlobalId id : {0, 1}) {
    const auto s = bench.state(id);
    EXPECT_EQ(s.x[0], 0.5);
    EXPECT_EQ(s.x[1], 0.5);
    EXPECT_EQ(s.v[0], 0.0);
    EXPECT_EQ(s.omega, Vec3{});
  }
}

TEST_F(Extremes, WithoutGravityNothingSettlesAndLayersEnd) {
  const auto record = valid({"jamming.gravity=0", "dynamics.time_step=1e-4", "layers.duration=0.01", "layers.maximum=0",
                             "dynamics.stop=settled"});
  EXPECT_TRUE(record.reached);
  EXPECT_EQ(record.kinetic_energy, 0.0);
  EXPECT_EQ(record.layers.front().stop_reason, "duration");
  EXPECT_THAT(refused({"jamming.gravity=0"}), HasSubstr("\"auto\" needs gravity or a speed at insertion"));
}

// The weight goes into the fluid: all sink at m g / c, to the last digits as c dt = m / 2.
TEST_F(Extremes, DragDominating) {
  const double dt = 1e-4;
  const auto drag = [&](double share) { return fmt::format("drag.coefficient={:.17g}", share * brick_mass / dt); };
  const auto record = valid({drag(0.5), "dynamics.time_step=1e-4", "layers.duration=0.1"});
  const double speed = 5.0 * dt / 0.5;
  const double expected = 0.5 * brick_mass * speed * speed * static_cast<double>(record.particles);
  EXPECT_NEAR(record.kinetic_energy, expected, 1e-9 * expected);
  EXPECT_THAT(refused({drag(1.01), "dynamics.time_step=1e-4"}), HasSubstr("stops the lightest particle within"));
}

TEST_F(Extremes, StepsFromATenthToAHundredTimesTheLimit) {
  const double limit = scene::build(input::parse(brick, "brick.toml", {})).time_step;
  const auto step = [&](double factor) { return "dynamics.time_step=" + std::to_string(factor * limit); };
  (void)valid({"dynamics.time_step=" + fmt::format("{:.17g}", 0.1 * limit), "layers.duration=0.1"});
  (void)valid({"dynamics.time_step=" + fmt::format("{:.17g}", 0.999 * limit)});
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
  (void)valid({"container.boundary=[\"periodic\", \"wall\"]", "container.size=[0.1261, 0.2, 0.05]"});
  EXPECT_THAT(refused({"container.boundary=[\"periodic\", \"wall\"]", "container.size=[0.1259, 0.2, 0.05]"}),
              HasSubstr("a periodic axis must be at least 0.126 m"));
}

TEST_F(Extremes, NearFieldBeyondTheRangeOfNumbers) {
  EXPECT_THAT(refused({"near_field.alpha2=1", "near_field.beta2=300", "near_field.cutoff=0.06"}),
              HasSubstr("near_field: the force at a distance of 0.02 m is beyond the range of numbers"));
}

TEST_F(Extremes, GradedSizesThatCannotFit) {
  const auto graded = [](const std::string& max) {
    return "particles.radius={ distribution = \"uniform\", min = 0.01, max = " + max + ", weighting = \"mass\" }";
  };
  EXPECT_THAT(refused({graded("0.03")}), HasSubstr("more than container.size[2] = 0.05 m"));
  EXPECT_THAT(refused({graded("0.02"), "layers.thickness=0.039"}), HasSubstr("is less than the largest particle"));
  EXPECT_THAT(refused({graded("0.02"), "layers.fraction=0.5", "layers.attempts=200"}), HasSubstr("at size class"));
  EXPECT_THAT(refused({graded("0.02"), "layers.fraction=0.9"}), HasSubstr("cannot be reached by random insertion"));
  // Just as high as the layer: all large ones have their centres at one height.
  (void)valid({graded("0.02"), "layers.thickness=0.04", "layers.fraction=0.1"});
}

// As many ranks as columns, or one too many.
TEST_F(Extremes, MoreRanksThanColumns) {
  const int ranks = comm_.size();
  const auto across = [](int columns) { return fmt::format("container.size=[{}, 0.05, 0.05]", 0.0421 * columns); };
  for (const char* kind : {"slab", "pencil", "metis"}) {
    const std::string decomposition = fmt::format("parallel.decomposition={}", kind);
    (void)valid({across(std::max(2, ranks)), "layers.fraction=0.05", decomposition});
    if (ranks < 3) continue;  // a box of one column is narrower than two particles
    EXPECT_THAT(refused({across(ranks - 1), "layers.fraction=0.05", decomposition}),
                HasSubstr(fmt::format("use at most {} ranks", ranks - 1)));
  }
}

// What is smaller than any number that matters counts as nothing, and -0 as 0: to the bit.
TEST_F(Extremes, DenormalsAndMinusZero) {
  (void)valid({});
  const pack::PackRows plain = rows_;
  (void)valid({"layers.velocity=[-0.0, 4.9e-324, -0.0]", "layers.spin=[-0.0, -0.0, 4.9e-324]",
               "drag.fluid_velocity=[-0.0, -0.0, -0.0]", "drag.coefficient=4.9e-324"});
  for (std::size_t k = 0; k < plain.id.size(); ++k) {
    EXPECT_EQ(rows_.position[k], plain.position[k]);
    EXPECT_EQ(rows_.velocity[k], plain.velocity[k]);
    EXPECT_EQ(rows_.spin[k], plain.spin[k]);
  }
  for (const char* tiny : {"particles.radius.value", "particles.youngs_modulus", "particles.density",
                           "layers.thickness", "dynamics.time_step"}) {
    for (const char* value : {"4.9e-324", "-0.0"}) (void)refused({fmt::format("{}={}", tiny, value)});
  }
  (void)refused({"layers.duration=-0.0"});
  (void)valid({"layers.duration=4.9e-324"});  // a step
}

// The same layer under other names: the same motion, contacts and frozen ones, to the bit.
TEST_F(Extremes, IdsBeyondTwoToTheThirtyThird) {
  const scene::Scene scene = scene::build(input::parse(brick, "brick.toml", {{"layers.velocity=[0, 0, -1]"}}));
  using Motion = std::vector<std::tuple<GlobalId, Vec3, Vec3>>;
  using Forces = std::vector<std::tuple<GlobalId, GlobalId, Vec3>>;
  const auto settle = [&](GlobalId base) {
    Bed bed(comm_, scene);
    const rsa::LayerRegion region{.layer = 0, .bottom = 0.0, .thickness = 0.2, .first_id = base};
    const rsa::Insertion got = rsa::insert(comm_, scene, bed.ownership, region, bed.store);
    bed.neighborhood.rebuild(bed.store);
    bed.stepper.advance(bed.store, bed.neighborhood, 600);
    bed.neighborhood.freeze(bed.store, base + got.inserted / 2);
    bed.neighborhood.rebuild(bed.store);
    bed.stepper.advance(bed.store, bed.neighborhood, 100);
    EXPECT_EQ(comm_.sum(std::int64_t{bed.neighborhood.frozen().owned()}), got.inserted / 2);
    bed.neighborhood.release(bed.store);
    bed.neighborhood.rebuild(bed.store);
    bed.stepper.advance(bed.store, bed.neighborhood, 100);
    EXPECT_EQ(observe::validity(comm_, bed.store, scene).found, got.inserted);
    const double energy = observe::energy_of(comm_, bed.store, scene, base, base + got.inserted);
    EXPECT_GT(energy, 0.0);
    EXPECT_EQ(observe::energy_of(comm_, bed.store, scene, base + got.inserted, base + 2 * got.inserted), 0.0);
    Motion motion;
    for (LocalIndex i = 0; i < bed.store.owned(); ++i) {
      motion.emplace_back(bed.store.ids()[static_cast<std::size_t>(i)] - base, bed.store.position(i),
                          bed.store.velocity(i));
    }
    Forces forces;
    for (const auto& c : observe::contact_forces(bed.store, scene, bed.neighborhood.pairs())) {
      EXPECT_LT(c.first, c.second);
      forces.emplace_back(c.first - base, c.second - base, c.force);
    }
    EXPECT_GT(comm_.sum(std::ssize(forces)), 0);
    std::ranges::sort(motion);
    std::ranges::sort(forces);
    return std::tuple(motion, forces, energy);
  };
  const auto plain = settle(0);
  for (const GlobalId base : {(GlobalId{1} << 31) - 5, (GlobalId{1} << 33) - 5, GlobalId{1} << 40}) {
    EXPECT_EQ(settle(base), plain) << base;
  }
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
