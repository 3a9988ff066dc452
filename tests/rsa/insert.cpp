// The parallel insertion against the serial loop, particle by particle, in all decompositions.
#include "rsa/insert.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <optional>

#include "geometry/volume.hpp"
#include "rsa/excluded.hpp"
#include "support/oracle_rsa.hpp"
#include "support/rsa_scenes.hpp"

namespace packmpi {
namespace {

using input::Decomposition;
using scene::Ownership;
using test::equal_radius;
using test::gaussian_radius;
using test::rsa_scene;
using test::uniform_radius;

constexpr std::array kinds{Decomposition::slab, Decomposition::pencil, Decomposition::metis};

// None where this many ranks cannot share the scene that way.
std::optional<Ownership> try_ownership(const comm::Comm& comm, const geometry::ColumnGrid& grid, Decomposition kind) {
  try {
    return Ownership(comm, grid, kind);
  } catch (const Error&) {
    return std::nullopt;
  }
}

void expect_same_spheres(const particles::Store& store, const Ownership& ownership, Rank rank,
                         const oracle::Rsa& serial, GlobalId first_id) {
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const auto particle = static_cast<std::uint64_t>(store.ids()[static_cast<std::size_t>(i)] - first_id);
    const auto found = std::ranges::lower_bound(serial.placed, particle, {}, &oracle::PlacedSphere::particle);
    ASSERT_TRUE(found != serial.placed.end() && found->particle == particle) << "particle " << particle;
    EXPECT_EQ(store.position(i), found->position)
        << "particle " << particle << ", placed in attempt " << found->attempt;
    EXPECT_EQ(store.radius(i), found->radius);
    EXPECT_EQ(ownership.owner(ownership.grid().column(store.position(i))), rank);
  }
}

// Runs the scene in every decomposition that these ranks allow.
void expect_serial_result(const scene::Scene& scene, const rsa::LayerRegion& region) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const oracle::Rsa serial = oracle::insert(scene, region, static_cast<std::uint32_t>(scene.in.layers.attempts));
  ASSERT_EQ(static_cast<std::int64_t>(serial.placed.size()), serial.target) << "the case asks for too much";
  int tried = 0;
  for (const Decomposition kind : kinds) {
    const auto ownership = try_ownership(comm, test::rsa_grid(scene), kind);
    if (!ownership) continue;
    ++tried;
    particles::Store store(scene.features.layout());
    const rsa::Insertion got = rsa::insert(comm, scene, *ownership, region, store);
    EXPECT_EQ(got.target, serial.target);
    EXPECT_EQ(got.inserted, serial.target);
    EXPECT_EQ(got.trials, serial.trials);
    EXPECT_EQ(comm.sum(std::int64_t{store.owned()}), serial.target);
    expect_same_spheres(store, *ownership, comm.rank(), serial, region.first_id);
  }
  EXPECT_GE(tried, 2);
}

constexpr std::array<bool, 2> walls{false, false};
constexpr std::array<bool, 2> periodic{true, true};

TEST(Insert, EqualSpheresBetweenWalls) {
  expect_serial_result(rsa_scene(3, {1.0, 0.8, 1.0}, walls, equal_radius(0.04), 0.25, 10000), {0, 0.0, 0.4, 0});
}

TEST(Insert, SpheresInACylinder) {
  for (const input::Radius& radius : {equal_radius(0.04), uniform_radius(0.02, 0.05)}) {
    scene::Scene scene = rsa_scene(3, {1.0, 1.0, 1.0}, walls, radius, 0.25, 10000);
    scene.container.shape = geometry::Shape::cylinder;
    expect_serial_result(scene, {0, 0.0, 0.4, 0});
    const comm::Comm comm(MPI_COMM_WORLD);
    const Ownership ownership(comm, test::rsa_grid(scene), Decomposition::slab);
    particles::Store store(scene.features.layout());
    const rsa::Insertion got = rsa::insert(comm, scene, ownership, {0, 0.0, 0.4, 0}, store);
    const double room = 3.14159265358979 * 0.25 * 0.4;
    EXPECT_GE(got.solid_volume, 0.25 * room);
    EXPECT_LT(got.solid_volume, 0.25 * room + geometry::volume(3, 0.05));
    for (LocalIndex i = 0; i < store.owned(); ++i) {
      const Vec3 x = store.position(i);
      EXPECT_LE(std::hypot(x[0] - 0.5, x[1] - 0.5) + store.radius(i), 0.5 + 1e-12);
    }
  }
}

TEST(Insert, EqualSpheresPeriodic) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    expect_serial_result(rsa_scene(3, {1.0, 0.8, 1.0}, periodic, equal_radius(0.04), 0.28, 10000, seed),
                         {3, 0.37, 0.4, 1000});
  }
}

TEST(Insert, GaussianSpheresMixedAxes) {
  expect_serial_result(
      rsa_scene(3, {0.9, 1.1, 1.0}, {true, false}, gaussian_radius(0.04, 0.004, 0.028, 0.052), 0.25, 10000),
      {1, 0.1, 0.4, 7});
}

// Wide size classes, and a grid of cells for each two of them.
TEST(Insert, SmallOnesBetweenTwentyTimesLargerOnes) {
  input::Radius radius;
  radius.distribution = input::SizeDistribution::bidisperse;
  radius.weighting = input::Weighting::mass;
  radius.small = 0.0025;
  radius.large = 0.05;
  radius.large_share = 0.95;
  expect_serial_result(rsa_scene(3, {0.5, 0.4, 0.5}, {false, true}, radius, 0.2, 10000), {2, 0.2, 0.25, 0});
  radius = uniform_radius(0.004, 0.05);
  radius.weighting = input::Weighting::mass;
  expect_serial_result(rsa_scene(3, {0.5, 0.4, 0.5}, {false, true}, radius, 0.2, 10000), {2, 0.2, 0.25, 0});
}

TEST(Insert, WidelyGradedSpheres) {
  expect_serial_result(rsa_scene(3, {1.0, 1.0, 1.0}, {false, true}, uniform_radius(0.015, 0.045), 0.3, 10000),
                       {0, 0.0, 0.25, 0});
}

// 5.4 of the paper: in the order of the indices its largest spheres find no room in a million trials.
TEST(Insert, LayerOfThePaper) {
  expect_serial_result(rsa_scene(3, {1.0, 1.0, 0.5}, walls, gaussian_radius(0.02, 0.002, 0.014, 0.026), 0.25, 10000),
                       {0, 0.0, 0.1, 0});
}

TEST(Insert, NearlyFullOfSpheres) {
  expect_serial_result(rsa_scene(3, {0.9, 0.9, 1.0}, periodic, equal_radius(0.04), 0.32, 100000), {0, 0.0, 0.8, 0});
}

TEST(Insert, DiscsBetweenWalls) {
  expect_serial_result(rsa_scene(2, {3.0, 1.0, 0.0}, walls, equal_radius(0.03), 0.4, 10000), {0, 0.0, 0.5, 0});
}

TEST(Insert, GradedDiscsPeriodic) {
  expect_serial_result(rsa_scene(2, {3.0, 1.0, 0.0}, periodic, gaussian_radius(0.03, 0.003, 0.021, 0.039), 0.42, 10000),
                       {5, 2.5, 0.5, 500});
}

TEST(Insert, NearlyFullOfDiscs) {
  expect_serial_result(rsa_scene(2, {3.0, 1.0, 0.0}, periodic, equal_radius(0.03), 0.49, 100000), {0, 0.0, 1.0, 0});
}

TEST(Insert, FewParticles) {
  expect_serial_result(rsa_scene(3, {1.0, 0.8, 1.0}, walls, equal_radius(0.04), 0.002, 10), {0, 0.0, 0.4, 0});
}

TEST(Insert, SparseLayerUsesWideCells) {
  expect_serial_result(rsa_scene(3, {4.0, 4.0, 1.0}, periodic, equal_radius(0.02), 0.001, 10), {0, 0.0, 1.0, 0});
}

TEST(Insert, GivesVelocityAndAppends) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const scene::Scene scene = rsa_scene(3, {1.0, 0.8, 1.0}, walls, equal_radius(0.04), 0.1, 100);
  const Ownership ownership(comm, test::rsa_grid(scene), Decomposition::metis);
  particles::Store store(scene.features.layout());
  const rsa::Insertion first = rsa::insert(comm, scene, ownership, {0, 0.0, 0.4, 0}, store);
  const rsa::Insertion second = rsa::insert(comm, scene, ownership, {1, 0.4, 0.4, first.inserted}, store);
  EXPECT_EQ(comm.sum(std::int64_t{store.owned()}), first.inserted + second.inserted);
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    EXPECT_EQ(store.velocity(i), scene.in.layers.velocity);
    const bool upper = store.ids()[static_cast<std::size_t>(i)] >= first.inserted;
    EXPECT_EQ(store.position(i)[2] > 0.4, upper);
  }
}

// What a run does that is stopped in an insertion and goes on later.
TEST(Insert, LeftBetweenVolleysAndBegunAnew) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const scene::Scene scene =
      rsa_scene(3, {1.0, 0.8, 1.0}, walls, gaussian_radius(0.03, 0.003, 0.021, 0.039), 0.25, 1000);
  const Ownership ownership(comm, test::rsa_grid(scene), Decomposition::slab);
  particles::Store store(scene.features.layout());
  const rsa::Insertion below = rsa::insert(comm, scene, ownership, {0, 0.0, 0.4, 0}, store);
  const LocalIndex kept = store.owned();
  const rsa::LayerRegion region{1, 0.4, 0.4, below.inserted};
  particles::Store whole(scene.features.layout());
  int volleys = 0;
  const rsa::Insertion once = rsa::insert(comm, scene, ownership, region, whole, [&] { ++volleys; });
  ASSERT_GT(volleys, 2);
  for (const int stop : {0, 1, volleys / 2, volleys - 1}) {
    int left = stop;
    const auto leave = [&] {
      if (left-- == 0) throw Error(ExitCode::stopped_early, "enough");
    };
    EXPECT_THROW((void)rsa::insert(comm, scene, ownership, region, store, leave), Error);
    EXPECT_EQ(comm.sum(std::int64_t{store.owned()}) > below.inserted, stop > 0) << stop;
    store.keep_first(kept);
  }
  const rsa::Insertion again = rsa::insert(comm, scene, ownership, region, store);
  EXPECT_EQ(again.inserted, once.inserted);
  EXPECT_EQ(again.trials, once.trials);
  ASSERT_EQ(store.owned(), kept + whole.owned());
  for (LocalIndex i = 0; i < whole.owned(); ++i) {
    EXPECT_EQ(store.position(kept + i), whole.position(i));
    EXPECT_EQ(store.ids()[static_cast<std::size_t>(kept + i)], whole.ids()[static_cast<std::size_t>(i)]);
  }
}

// A layer that ends at H_d and cannot be filled to phi_0 is that of a scene that asks for fewer particles.
TEST(Insert, ClippedLayerTakesTheFirstOfItsParticles) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const int dimension : {2, 3}) {
    const Vec3 size = dimension == 3 ? Vec3{1.0, 0.8, 1.0} : Vec3{3.0, 1.0, 0.0};
    const double fraction = dimension == 3 ? 0.42 : 0.6;
    const scene::Scene scene =
        rsa_scene(dimension, size, walls, gaussian_radius(0.03, 0.003, 0.021, 0.039), fraction, 500);
    const rsa::LayerRegion region{.layer = 4, .bottom = 0.2, .thickness = 0.15, .first_id = 70, .clipped = true};
    const Ownership ownership(comm, test::rsa_grid(scene), Decomposition::slab);
    particles::Store store(scene.features.layout());
    const rsa::Insertion got = rsa::insert(comm, scene, ownership, region, store);
    EXPECT_LT(got.inserted, got.target);
    EXPECT_GT(got.inserted, got.target / 2);
    EXPECT_EQ(comm.sum(std::int64_t{store.owned()}), got.inserted);
    scene::Scene less = scene;
    less.in.layers.fraction = got.solid_volume /
                              (scene.container.mean_area(region.bottom, region.thickness) * region.thickness) *
                              (1.0 - 1e-12);
    const oracle::Rsa serial = oracle::insert(less, region, 500);
    EXPECT_EQ(std::ssize(serial.placed), got.inserted);
    expect_same_spheres(store, ownership, comm.rank(), serial, region.first_id);
  }
}

// The complaint of insert(), checked to be the same on all ranks.
std::string complaint(const scene::Scene& scene, const rsa::LayerRegion& region, Decomposition kind) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const Ownership ownership(comm, test::rsa_grid(scene), kind);
  particles::Store store(scene.features.layout());
  std::string words;
  try {
    (void)rsa::insert(comm, scene, ownership, region, store);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    words = error.what();
  }
  EXPECT_FALSE(words.empty());
  EXPECT_EQ(comm.broadcast(0, words), words);
  return words;
}

TEST(GiveUp, AfterTheAttemptsAllowed) {
  const scene::Scene scene = rsa_scene(3, {1.0, 0.8, 1.0}, periodic, equal_radius(0.04), 0.3, 12);
  const rsa::LayerRegion region{2, 0.0, 0.4, 0};
  const oracle::Rsa serial = oracle::insert(scene, region, 12);
  ASSERT_LT(static_cast<std::int64_t>(serial.placed.size()), serial.target);
  const double volume = static_cast<double>(serial.placed.size()) * 4.0 / 3.0 * 3.14159265358979 * 0.04 * 0.04 * 0.04;
  for (const Decomposition kind : {Decomposition::slab, Decomposition::metis}) {
    EXPECT_THAT(complaint(scene, region, kind),
                testing::StartsWith(
                    fmt::format("layer 3: random sequential addition placed {} of {} particles: solid fraction "
                                "{:.4f} of 0.3000, after {} trials; it ended in 12 of 12 attempts a particle. Lower",
                                serial.placed.size(), serial.target, volume / (0.8 * 0.4), serial.trials)));
  }
}

TEST(GiveUp, EarlyWhenTheRestCannotFit) {
  const scene::Scene scene = rsa_scene(2, {3.0, 1.0, 0.0}, periodic, equal_radius(0.03), 0.8, 2000);
  const rsa::LayerRegion region{0, 0.0, 1.0, 0};
  const std::string words = complaint(scene, region, Decomposition::slab);
  const std::size_t at = words.find("ended in ");
  ASSERT_NE(at, std::string::npos) << words;
  const int attempts = std::stoi(words.substr(at + 9));
  EXPECT_LT(attempts, 1000);
  const oracle::Rsa serial = oracle::insert(scene, region, static_cast<std::uint32_t>(attempts));
  EXPECT_THAT(words, testing::HasSubstr(fmt::format("placed {} of {} particles", serial.placed.size(), serial.target)));
  EXPECT_THAT(words, testing::HasSubstr(
                         fmt::format("after {} trials; it ended in {} of 2000 attempts", serial.trials, attempts)));
}

TEST(GiveUp, NamesTheSizeClass) {
  const scene::Scene scene = rsa_scene(3, {1.0, 0.8, 1.0}, walls, uniform_radius(0.03, 0.05), 0.45, 50);
  const rsa::LayerRegion region{0, 0.0, 0.4, 0};
  const oracle::Rsa serial = oracle::insert(scene, region, 50);
  const std::string words = complaint(scene, region, Decomposition::slab);
  EXPECT_THAT(words, testing::HasSubstr(fmt::format("placed {} of {} particles", serial.placed.size(), serial.target)));
  EXPECT_THAT(words, testing::HasSubstr(fmt::format("after {} trials; it ended in 50 of 50 attempts", serial.trials)));
  EXPECT_THAT(words, testing::ContainsRegex("at size class [2-8] of 8, from the largest down"));
}

TEST(GiveUp, LayerThinnerThanAParticle) {
  const scene::Scene scene = rsa_scene(3, {1.0, 0.8, 1.0}, walls, equal_radius(0.04), 0.3, 12);
  EXPECT_THAT(complaint(scene, {0, 0.0, 0.079, 0}, Decomposition::slab),
              testing::HasSubstr("layers.thickness = 0.079 m"));
}

// Whatever the voxels, ranks and sizes: where the map says that there is no room, the smallest sphere overlaps one that
// is placed; and of a dense layer it knows most of that.
TEST(Excluded, SaysOnlyWhatIsSo) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const int dimension : {2, 3}) {
    for (const auto& radius : {equal_radius(0.02), uniform_radius(0.01, 0.03)}) {
      const scene::Scene scene = rsa_scene(dimension, {1.0, dimension == 3 ? 0.5 : 0.4, 0.3}, {true, false}, radius,
                                           dimension == 3 ? 0.28 : 0.45, 100000);
      const auto ownership = try_ownership(comm, test::rsa_grid(scene), Decomposition::slab);
      if (!ownership) continue;
      const rsa::LayerRegion region{0, 0.1, 0.25, 0};
      particles::Store store(scene.features.layout());
      const std::int64_t asked = rsa::insert(comm, scene, *ownership, region, store).inserted;
      rsa::Excluded excluded(scene, *ownership, region, asked);
      const rsa::Metric metric(scene.container);
      std::vector<rsa::Sphere> placed;
      for (LocalIndex i = 0; i < store.owned(); ++i) {
        placed.push_back({store.position(i), store.radius(i)});
        excluded.add(placed.back());
      }
      int taken = 0, known = 0;
      for (std::uint64_t k = 0; k < 20000; ++k) {
        const rsa::Sphere trial{rsa::trial(scene, region, k, scene.sizes.smallest(), 7), scene.sizes.smallest()};
        if (ownership->owner(ownership->grid().column(trial.centre)) != comm.rank()) continue;
        const bool overlaps = std::ranges::any_of(placed, [&](const auto& s) { return metric.overlap(trial, s); });
        taken += overlaps ? 1 : 0;
        if (!excluded.holds(trial.centre)) continue;
        ++known;
        EXPECT_TRUE(overlaps) << dimension << "D, trial " << k;
      }
      EXPECT_GT(known, 0.4 * taken) << dimension << "D";
    }
  }
}

}  // namespace
}  // namespace packmpi
