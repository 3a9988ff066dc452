// Numbers whose last bits the C library would choose by CPU: each digest is the same on every machine. CTest runs this
// a second time on a CPU that glibc takes for one without FMA and AVX2.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "dynamics/near_field.hpp"
#include "geometry/volume.hpp"
#include "scene/sizes.hpp"

namespace packmpi::dynamics {
namespace {

constexpr int count = 200000;  // of a hundred thousand values of sin or pow about seventy differ

template <class Function>
std::uint64_t digest(Function&& function, int values = count) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (int k = 1; k < values; ++k) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(function(static_cast<double>(k) / values))) * 0x100000001b3ULL;
  }
  return hash;
}

TEST(AnyCpu, AreasOfCutDiscs) {
  EXPECT_EQ(digest([](double x) { return geometry::volume_below(2, 0.5, 0.5, x); }), 1935146260264698605U);
}

TEST(AnyCpu, NearFieldsOfAnyExponent) {
  EXPECT_EQ(digest([](double x) { return inverse_power(1e-3 + x, 4.0 / 3.0); }), 5559361073818841844U);
  EXPECT_EQ(digest([](double x) { return inverse_power(0.01, 10.0 * x); }), 682547563973260978U);
}

TEST(AnyCpu, MeansOfTruncatedGaussians) {
  const auto mean = [](double x) {
    input::Radius radius;
    radius.distribution = input::SizeDistribution::gaussian;
    radius.weighting = input::Weighting::number;
    radius.mean = 0.01;
    radius.sd = 0.001 + 0.004 * x;
    radius.min = 0.009;
    radius.max = 0.012;
    return scene::Sizes(radius, 1).mean();
  };
  EXPECT_EQ(digest(mean, 50), 2313265192602568937U);  // each makes its curve, too
}

}  // namespace
}  // namespace packmpi::dynamics
