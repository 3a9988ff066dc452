// Samples whose diameters and distances are known, on any number of ranks.
#include "observe/size_match.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace packmpi::observe {
namespace {

constexpr double resolution = 1.3e-4;  // of the distance for curves without classes

input::Radius uniform(double min, double max) {
  input::Radius radius;
  radius.distribution = input::SizeDistribution::uniform;
  radius.min = min;
  radius.max = max;
  return radius;
}

input::Radius classes(std::vector<double> radii, std::vector<double> shares) {
  input::Radius radius;
  radius.distribution = input::SizeDistribution::discrete;
  radius.radii = std::move(radii);
  const double all = std::accumulate(shares.begin(), shares.end(), 0.0);
  for (double& share : shares) share /= all;
  radius.shares = std::move(shares);
  return radius;
}

/// `count` particles of each radius.
std::vector<double> of_classes(const std::vector<std::pair<double, int>>& counts) {
  std::vector<double> radii;
  for (const auto& [r, count] : counts) radii.insert(radii.end(), static_cast<std::size_t>(count), r);
  return radii;
}

std::vector<double> evenly(double min, double max, int count) {
  std::vector<double> radii;
  for (int k = 0; k < count; ++k) radii.push_back(min + (k + 0.5) / count * (max - min));
  return radii;
}

SizeMatches match(const comm::Comm& comm, const std::vector<double>& radii, const input::Radius& asked) {
  particles::Store store(particles::layout_of(3, false));
  for (std::size_t k = 0; k < radii.size(); ++k) {  // in another order than the radii, by uneven shares
    const std::size_t at = k * 7919 % radii.size();
    if (static_cast<int>(at * at % 5) % comm.size() != comm.rank()) continue;
    store.add(static_cast<GlobalId>(at), {}, radii[at], {}, {});
  }
  return size_match(comm, store, scene::SizeCurve(asked));
}

class Sizes : public ::testing::Test {
 protected:
  const comm::Comm world_{MPI_COMM_WORLD};
  [[nodiscard]] SizeMatches of(const std::vector<double>& radii, const input::Radius& asked) const {
    return match(world_, radii, asked);
  }
};

TEST_F(Sizes, ClassesAreExact) {
  const SizeMatches m = of(of_classes({{1e-3, 50}, {2e-3, 30}, {4e-3, 20}}), classes({1e-3, 2e-3, 4e-3}, {5, 3, 2}));
  for (const SizePoints& p : {m.by_number.target, m.by_number.achieved}) {
    EXPECT_EQ(p.d10, 2e-3);
    EXPECT_EQ(p.d30, 2e-3);
    EXPECT_EQ(p.d50, 2e-3) << "half are of the first class: not exceeded";
    EXPECT_EQ(p.d60, 4e-3);
    EXPECT_EQ(p.d90, 8e-3);
    EXPECT_EQ(p.uniformity(), 2.0);
    EXPECT_EQ(p.curvature(), 0.5);
  }
  // Masses 50, 240, 1280 of 1570: a tenth of it is reached in the second class, all else in the third.
  for (const SizePoints& p : {m.by_mass.target, m.by_mass.achieved}) {
    EXPECT_EQ(p.d10, 4e-3);
    EXPECT_EQ(p.d30, 8e-3);
    EXPECT_EQ(p.d90, 8e-3);
  }
  EXPECT_LT(m.by_number.distance, 1e-12);
  EXPECT_LT(m.by_mass.distance, 1e-12);
}

TEST_F(Sizes, TheDistanceOfClassesIsThatOfTheirShares) {
  const SizeMatches m = of(of_classes({{1e-3, 60}, {2e-3, 20}, {4e-3, 20}}), classes({1e-3, 2e-3, 4e-3}, {5, 3, 2}));
  EXPECT_NEAR(m.by_number.distance, 0.1, 1e-12);
  EXPECT_EQ(m.by_number.achieved.d50, 2e-3);
  const double asked = (50.0 + 240.0) / 1570.0;  // of the mass up to the second class
  const double got = (60.0 + 160.0) / 1500.0;
  EXPECT_NEAR(m.by_mass.distance, asked - got, 1e-12);
}

TEST_F(Sizes, AUniformSample) {
  constexpr double a = 0.01, b = 0.02;
  constexpr int count = 1000;
  const std::vector<double> radii = evenly(a, b, count);
  const SizeMatches m = of(radii, uniform(a, b));
  EXPECT_EQ(m.by_number.achieved.d10, 2.0 * radii[99]) << "the hundredth smallest";
  EXPECT_EQ(m.by_number.achieved.d60, 2.0 * radii[599]);
  EXPECT_EQ(m.by_number.achieved.d90, 2.0 * radii[899]);
  EXPECT_NEAR(m.by_number.target.d30, 2.0 * 0.013, 1e-15);
  EXPECT_LE(m.by_number.distance, 0.5 / count + 1e-12);
  EXPECT_GE(m.by_number.distance, 0.5 / count - resolution);
  // By mass, a share s is below r with r^4 = a^4 + s (b^4 - a^4).
  const double half = 2.0 * std::pow(0.5 * (std::pow(a, 4) + std::pow(b, 4)), 0.25);
  EXPECT_NEAR(m.by_mass.target.d50, half, 1e-14);
  EXPECT_NEAR(m.by_mass.achieved.d50, half, 2.0 * (b - a) / count);
}

TEST_F(Sizes, HalfADistributionIsHalfAway) {
  const std::vector<double> radii = evenly(0.015, 0.02, 400);
  const SizeMatches m = of(radii, uniform(0.01, 0.02));
  // Largest just below the first particle: all that is asked there is missing.
  const double first = radii.front() / 0.01;
  const double by_number = first - 1.0;
  const double by_mass = (std::pow(first, 4) - 1.0) / (std::pow(2.0, 4) - 1.0);
  EXPECT_NEAR(by_number, 0.5, 1e-3);
  EXPECT_NEAR(m.by_number.distance, by_number, resolution);
  EXPECT_LE(m.by_number.distance, by_number + 1e-12);
  EXPECT_NEAR(m.by_mass.distance, by_mass, resolution);
  EXPECT_LE(m.by_mass.distance, by_mass + 1e-12);
}

TEST_F(Sizes, EqualRadiiAndNone) {
  input::Radius equal;
  equal.value = 0.02;
  const SizeMatches m = of(std::vector<double>(17, 0.02), equal);
  EXPECT_EQ(m.by_mass.achieved.d10, 0.04);
  EXPECT_EQ(m.by_number.achieved.d90, 0.04);
  EXPECT_EQ(m.by_number.achieved.uniformity(), 1.0);
  EXPECT_EQ(m.by_number.distance, 0.0);
  EXPECT_EQ(m.by_mass.distance, 0.0);
  const SizeMatches none = of({}, equal);
  EXPECT_EQ(none.by_number.achieved.d50, 0.0);
  EXPECT_EQ(none.by_number.target.d50, 0.04);
}

TEST_F(Sizes, SameBitsOnAnyNumberOfRanks) {
  input::Radius asked;
  asked.distribution = input::SizeDistribution::lognormal;
  asked.weighting = input::Weighting::mass;
  asked.median = 0.01;
  asked.log_sd = 0.4;
  asked.min = 0.002;
  asked.max = 0.05;
  std::vector<double> radii;
  const scene::SizeCurve curve(asked);
  for (int k = 0; k < 3000; ++k) {
    radii.push_back(curve.draw(std::fmod(k * 0.6180339887, 1.0), std::fmod(k * 0.7548776662, 1.0)));
  }
  const SizeMatches here = of(radii, asked);
  const SizeMatches alone = match(comm::Comm(MPI_COMM_SELF), radii, asked);
  for (const auto& [x, y] : {std::pair{here.by_number, alone.by_number}, std::pair{here.by_mass, alone.by_mass}}) {
    EXPECT_EQ(x.distance, y.distance);
    EXPECT_EQ(x.achieved.d10, y.achieved.d10);
    EXPECT_EQ(x.achieved.d30, y.achieved.d30);
    EXPECT_EQ(x.achieved.d50, y.achieved.d50);
    EXPECT_EQ(x.achieved.d60, y.achieved.d60);
    EXPECT_EQ(x.achieved.d90, y.achieved.d90);
  }
  EXPECT_LT(here.by_number.distance, 0.01) << "an even sample of it";
  EXPECT_GT(here.by_number.distance, 0.0);
}

}  // namespace
}  // namespace packmpi::observe
