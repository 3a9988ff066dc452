// What a layer must be whatever the method: the count asked for, no overlap, uniform, inside.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "geometry/volume.hpp"
#include "rsa/insert.hpp"
#include "support/oracle_rsa.hpp"
#include "support/rsa_scenes.hpp"

namespace packmpi {
namespace {

using test::equal_radius;
using test::gaussian_radius;
using test::rsa_scene;
using test::uniform_radius;

constexpr std::array<bool, 2> walls{false, false};
constexpr std::array<bool, 2> periodic{true, true};

TEST(Count, SmallestThatFillsTheFraction) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const input::Radius& radius :
       {equal_radius(0.01), gaussian_radius(0.01, 0.001, 0.007, 0.013), uniform_radius(0.002, 0.02)}) {
    for (const double fraction : {1e-5, 0.01, 0.1, 0.25, 0.3}) {
      const scene::Scene flat = rsa_scene(2, {7.0, 1.0, 0.0}, walls, radius, fraction, 1);
      EXPECT_EQ(rsa::particles_needed(comm, flat, {4, 0.0, 0.5, 0}), oracle::particles_needed(flat, {4, 0.0, 0.5, 0}));
      const scene::Scene solid = rsa_scene(3, {1.3, 1.0, 1.0}, walls, radius, fraction, 1);
      EXPECT_EQ(rsa::particles_needed(comm, solid, {9, 0.0, 0.2, 0}),
                oracle::particles_needed(solid, {9, 0.0, 0.2, 0}));
    }
  }
}

TEST(Overlap, IsThatOfTheNearestImages) {
  const geometry::Container box{3, {1.0, 0.7, 2.0}, {true, false}};
  EXPECT_TRUE(rsa::overlap(box, {0.05, 0.3, 0.5}, 0.06, {0.95, 0.3, 0.5}, 0.06));
  EXPECT_FALSE(rsa::overlap(box, {0.3, 0.02, 0.5}, 0.06, {0.3, 0.68, 0.5}, 0.06));
  EXPECT_FALSE(rsa::overlap(box, {0.25, 0.25, 0.5}, 0.125, {0.5, 0.25, 0.5}, 0.125)) << "touching is not overlapping";
  EXPECT_TRUE(rsa::overlap(box, {0.25, 0.25, 0.5}, 0.125, {0.5, 0.25, 0.5}, 0.125 * (1.0 + 1e-15)));
  const scene::Scene scene = rsa_scene(3, {1.0, 0.7, 2.0}, {true, false}, equal_radius(0.1), 0.1, 1);
  for (std::uint64_t k = 0; k < 2000; ++k) {
    const Vec3 a = rsa::trial(scene, {0, 0.0, 0.5, 0}, k, 0.0, 0);
    const Vec3 b = rsa::trial(scene, {0, 0.0, 0.5, 0}, k, 0.0, 1);
    bool any = false;
    for (const double shift : {-1.0, 0.0, 1.0}) any |= std::hypot(a[0] - b[0] + shift, a[1] - b[1], a[2] - b[2]) < 0.3;
    EXPECT_EQ(rsa::overlap(box, a, 0.1, b, 0.2), any);
    EXPECT_EQ(rsa::overlap(box, b, 0.2, a, 0.1), any);
  }
}

TEST(Trial, WholeSphereInsideAndUniform) {
  const scene::Scene scene = rsa_scene(3, {1.0, 0.7, 2.0}, {true, false}, equal_radius(0.1), 0.1, 1);
  const rsa::LayerRegion region{1, 0.4, 0.5, 0};
  constexpr int n = 20000;
  Vec3 mean{};
  for (std::uint64_t k = 0; k < n; ++k) {
    const Vec3 x = rsa::trial(scene, region, k, 0.1, 3);
    EXPECT_TRUE(x[0] >= 0.0 && x[0] < 1.0);
    EXPECT_TRUE(x[1] >= 0.1 && x[1] <= 0.6 + 1e-15);
    EXPECT_TRUE(x[2] >= 0.5 && x[2] <= 0.8 + 1e-15);
    for (std::size_t axis = 0; axis < 3; ++axis) mean[axis] += x[axis] / n;
  }
  const double sigma = 1.0 / std::sqrt(12.0 * n);  // of a mean over an interval of length 1
  EXPECT_NEAR(mean[0], 0.5, 4 * sigma);
  EXPECT_NEAR(mean[1], 0.35, 4 * sigma * 0.5);
  EXPECT_NEAR(mean[2], 0.65, 4 * sigma * 0.3);
}

struct Ball {
  Vec3 position;
  double radius;
};

// Every rank's particles, on every rank.
std::vector<Ball> everywhere(const comm::Comm& comm, const particles::Store& store) {
  std::vector<Ball> mine;
  for (LocalIndex i = 0; i < store.owned(); ++i) mine.push_back({store.position(i), store.radius(i)});
  const auto bytes = std::as_bytes(std::span(mine));
  std::vector<comm::Parcel> parcels;
  for (Rank rank = 0; rank < comm.size(); ++rank) parcels.push_back({rank, {bytes.begin(), bytes.end()}});
  std::vector<Ball> all;
  for (const comm::Parcel& parcel : comm::exchange(comm, std::move(parcels))) {
    const std::size_t old = all.size();
    all.resize(old + parcel.bytes.size() / sizeof(Ball));
    std::memcpy(all.data() + old, parcel.bytes.data(), parcel.bytes.size());
  }
  return all;
}

TEST(Layer, FullNoOverlapUniform) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const scene::Scene scene =
      rsa_scene(3, {1.0, 1.0, 1.0}, periodic, gaussian_radius(0.02, 0.002, 0.014, 0.026), 0.25, 10000);
  const scene::Ownership ownership(comm, test::rsa_grid(scene), input::Decomposition::pencil);
  particles::Store store(scene.features.layout());
  const rsa::Insertion got = rsa::insert(comm, scene, ownership, {0, 0.0, 0.5, 0}, store);
  const std::vector<Ball> balls = everywhere(comm, store);
  ASSERT_EQ(static_cast<std::int64_t>(balls.size()), got.inserted);

  double volume = 0.0, largest = 0.0;
  std::array<int, 64> bins{};
  for (std::size_t i = 0; i < balls.size(); ++i) {
    const auto& [x, r] = balls[i];
    volume += geometry::volume(3, r);
    largest = std::max(largest, r);
    ++bins[static_cast<std::size_t>(x[0] * 8) + 8 * static_cast<std::size_t>(x[1] * 8)];
    for (std::size_t j = 0; j < i; ++j) {
      const auto d = [&](std::size_t axis) {
        return std::remainder(x[axis] - balls[j].position[axis], axis < 2 ? 1.0 : 1e9);
      };
      EXPECT_GE(std::hypot(d(0), d(1), d(2)), (r + balls[j].radius) * (1 - 1e-14));
    }
  }
  EXPECT_NEAR(got.solid_volume, volume, 1e-12 * volume);
  EXPECT_GE(volume, 0.25 * 0.5 * (1 - 1e-12));
  EXPECT_LT(volume, 0.25 * 0.5 + geometry::volume(3, largest));

  const double expected = static_cast<double>(balls.size()) / 64.0;
  double chi_squared = 0.0;
  for (const int count : bins) chi_squared += (count - expected) * (count - expected) / expected;
  EXPECT_LT(chi_squared, 63.0);  // hard spheres are more even than independent points (63 on average)
  EXPECT_GT(chi_squared, 2.0);   // but no lattice
}

}  // namespace
}  // namespace packmpi
