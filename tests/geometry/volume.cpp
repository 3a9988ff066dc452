// Cut volumes against numerical integration, exact values and the behaviour near tangency.
#include "geometry/volume.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <numbers>

namespace packmpi::geometry {
namespace {

constexpr long double pi = std::numbers::pi_v<long double>;

/// The part of the particle in [bottom, bottom + h], slice by slice. With t = 1 - cos(s), the slice's thickness is
/// r sin(s) ds and its half width r sin(s): smooth, so Simpson's rule converges fast even at tangency.
double integrated(int dimension, double radius, double h) {
  const long double r = radius;
  const long double end = 2.0L * std::asin(std::sqrt(h / (2.0L * r)));
  const int slices = 20000;
  long double sum = 0.0L;
  for (int i = 0; i <= slices; ++i) {
    const long double half_width = r * std::sin(end * i / slices);
    const long double area = dimension == 3 ? pi * half_width * half_width : 2.0L * half_width;
    sum += (i == 0 || i == slices ? 1.0L : (i % 2 == 1 ? 4.0L : 2.0L)) * area * half_width;
  }
  return static_cast<double>(sum * end / slices / 3.0L);
}

TEST(Volume, Whole) {
  EXPECT_DOUBLE_EQ(volume(3, 0.5), std::numbers::pi / 6.0);
  EXPECT_DOUBLE_EQ(volume(2, 0.5), std::numbers::pi / 4.0);
}

TEST(VolumeBelow, AgreesWithIntegration) {
  for (const int dimension : {2, 3}) {
    for (const double r : {0.02, 1.0, 3.7}) {
      for (const double part : {1e-12, 1e-8, 1e-4, 0.01, 0.1, 0.12, 0.13, 0.3, 0.5, 0.7, 0.99, 0.9999}) {
        const double h = part * 2.0 * r;
        const double got = volume_below(dimension, r, r, h);  // the bottom at zero: h is exact, so is the comparison
        const double expected = integrated(dimension, r, (h - r) + r);
        EXPECT_NEAR(got, expected, 2e-15 * expected + 4e-16 * volume(dimension, r))
            << dimension << " " << r << " " << part;
      }
    }
  }
}

TEST(VolumeBelow, KeepsItsDigitsNearTangency) {
  // Centre at the radius, a power of two: h = height - r + r loses nothing down to 2^-52.
  for (const double h : {0x1p-50, 0x1p-40, 0x1p-30, 0x1p-20, 0x1p-10}) {
    const double sphere = integrated(3, 1.0, h);
    const double disc = integrated(2, 1.0, h);
    EXPECT_NEAR(volume_below(3, 1.0, 1.0, h), sphere, 1e-14 * sphere) << h;
    EXPECT_NEAR(volume_below(2, 1.0, 1.0, h), disc, 1e-14 * disc) << h;
  }
}

TEST(VolumeBelow, NothingHalfAndAll) {
  for (const int dimension : {2, 3}) {
    const double whole = volume(dimension, 0.5);
    EXPECT_EQ(volume_below(dimension, 0.5, 2.0, 1.5), 0.0);
    EXPECT_EQ(volume_below(dimension, 0.5, 2.0, -7.0), 0.0);
    EXPECT_EQ(volume_below(dimension, 0.5, 2.0, 2.5), whole);
    EXPECT_EQ(volume_below(dimension, 0.5, 2.0, 9.0), whole);
    EXPECT_DOUBLE_EQ(volume_below(dimension, 0.5, 2.0, 2.0), 0.5 * whole);
  }
}

TEST(VolumeBelow, RisesWithThePlaneAndComplements) {
  for (const int dimension : {2, 3}) {
    const double whole = volume(dimension, 0.5);
    double last = 0.0;
    for (int i = 0; i <= 4096; ++i) {
      const double up = i * 0x1p-12;
      const double below = volume_below(dimension, 0.5, 0.5, up);
      EXPECT_GE(below, last);
      EXPECT_NEAR(below + volume_below(dimension, 0.5, 0.5, 1.0 - up), whole, 4e-16);
      last = below;
    }
    EXPECT_EQ(last, whole);
  }
}

}  // namespace
}  // namespace packmpi::geometry
