// Spheres cut by boxes, spheres and cylinders, against integrals over sections in another direction, by another rule.
#include "geometry/cut_volume.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "geometry/round_volume.hpp"
#include "geometry/volume.hpp"

namespace packmpi::geometry {
namespace {

constexpr double infinity = HUGE_VAL;
constexpr double promised = 1e-9;  // of r^3

/// By tanh-sinh, whose ends may be singular.
template <class Function>
long double summed(const Function& f, long double low, long double high) {
  constexpr long double step = 0.0625L;
  long double sum = 0.0L;
  for (int k = -52; k <= 52; ++k) {
    const long double t = step * k, turn = 0.5L * std::numbers::pi_v<long double> * std::sinh(t);
    const long double c = std::cosh(turn);
    const long double weight = 0.5L * std::numbers::pi_v<long double> * std::cosh(t) / (c * c);
    sum += weight * f(0.5L * (low + high) + 0.5L * (high - low) * std::tanh(turn));
  }
  return 0.5L * (high - low) * step * sum;
}

/// Between the places where it may have a corner, some of which may be outside.
template <class Function>
long double pieces(const Function& f, long double low, long double high, std::vector<long double> places) {
  std::erase_if(places, [&](long double x) { return !(x > low && x < high); });
  places.push_back(low), places.push_back(high);
  std::ranges::sort(places);
  long double sum = 0.0L;
  for (std::size_t k = 0; k + 1 < places.size(); ++k) sum += summed(f, places[k], places[k + 1]);
  return sum;
}

/// Plus and minus the root of r^2 less a square, if there is one.
void note(std::vector<long double>& places, long double rest) {
  if (!(rest > 0.0L)) return;
  places.push_back(std::sqrt(rest)), places.push_back(-std::sqrt(rest));
}

/// Of the sphere the part that is above the rectangle of x and y, between two heights: an integral of heights.
long double slow_box(long double r, const Vec3& low, const Vec3& high) {
  const auto bound = [&](double x) { return std::clamp(static_cast<long double>(x), -r, r); };
  const long double x0 = bound(low[0]), x1 = bound(high[0]), y0 = bound(low[1]), y1 = bound(high[1]);
  const long double z0 = bound(low[2]), z1 = bound(high[2]);
  if (!(x0 < x1 && y0 < y1 && z0 < z1)) return 0.0L;
  std::vector<long double> turns;
  for (const long double z : {0.0L, z0, z1}) {
    note(turns, r * r - z * z);
    for (const long double y : {y0, y1}) note(turns, r * r - y * y - z * z);
  }
  const auto strip = [&](long double x) {
    const long double square = std::max(0.0L, (r - x) * (r + x)), side = std::sqrt(square);
    const auto height = [&](long double y) {
      const long double h = std::sqrt(std::max(0.0L, square - y * y));
      return std::max(0.0L, std::min(z1, h) - std::max(z0, -h));
    };
    std::vector<long double> corners;
    for (const long double z : {z0, z1}) note(corners, square - z * z);
    const long double from = std::max(y0, -side), to = std::min(y1, side);
    return from < to ? pieces(height, from, to, corners) : 0.0L;
  };
  return pieces(strip, x0, x1, turns);
}

TEST(VolumeInBox, EqualsAnIntegralOfHeights) {
  std::mt19937_64 engine(11);
  const auto dice = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1p-53);
  };
  double largest = 0.0;
  for (int k = 0; k < 60; ++k) {
    const double r = dice(0.5, 2.0);
    Vec3 low{-infinity, -infinity, -infinity}, high{infinity, infinity, infinity};
    for (std::size_t a = 0; a < 3; ++a) {
      if (k % 3 != 0 || dice(0.0, 1.0) < 0.6) low[a] = dice(-1.2 * r, 0.9 * r);
      if (dice(0.0, 1.0) < 0.5) high[a] = std::max(low[a], -r) + dice(0.01, 1.5) * r;
    }
    const double expected = static_cast<double>(slow_box(r, low, high));
    const double error = std::abs(volume_in_box(r, low, high) - expected) / (r * r * r);
    EXPECT_LT(error, promised) << k << ' ' << r;
    largest = std::max(largest, error);
  }
  RecordProperty("largest_error", std::to_string(largest));
}

TEST(VolumeInBox, HasTheKnownForms) {
  const double r = 0.7, whole = volume(3, r);
  EXPECT_EQ(volume_in_box(r, {-1.0, -1.0, -1.0}, {1.0, 1.0, 1.0}), whole);
  EXPECT_EQ(volume_in_box(r, {0.7, -1.0, -1.0}, {1.0, 1.0, 1.0}), 0.0);
  EXPECT_EQ(volume_in_box(r, {-1.0, -1.0, 0.2}, {1.0, 1.0, 0.1}), 0.0);
  EXPECT_NEAR(volume_in_box(r, {0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}), whole / 8.0, promised);
  EXPECT_NEAR(volume_in_box(r, {0.1, -1.0, -1.0}, {1.0, 1.0, 1.0}), whole - volume_below(3, r, 0.0, 0.1), promised);
  EXPECT_NEAR(volume_in_box(r, {-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}), 0.008, promised);  // a cube inside the sphere
}

/// Boxes that fill the room share a sphere out.
TEST(VolumeInBox, AddsUp) {
  const double r = 1.0;
  for (const Vec3 at :
       {Vec3{0.0, 0.0, 0.0}, Vec3{0.3, -0.2, 0.6}, Vec3{0.7, 0.7, 0.1}, Vec3{0.57735, 0.57735, 0.57736}}) {
    double sum = 0.0;
    for (int k = 0; k < 8; ++k) {
      Vec3 low{}, high{};
      for (std::size_t a = 0; a < 3; ++a) {
        const bool upper = (k >> a & 1) != 0;
        low[a] = upper ? at[a] : -infinity, high[a] = upper ? infinity : at[a];
      }
      sum += volume_in_box(r, low, high);
    }
    EXPECT_NEAR(sum, volume(3, r), 2.0 * promised);
  }
}

TEST(VolumeInSphere, EqualsASumOfSections) {
  for (const double r : {0.4, 1.0}) {
    for (const double around : {0.3, 1.0, 5.0, 4000.0}) {
      for (int k = 1; k < 40; ++k) {
        const double b = std::abs(around - r) + 2.0 * std::min(r, around) * k / 40.0;
        // Along the line of the centres, from the small one's: the smaller of both sections.
        const auto section = [&](long double x) {
          const long double own = (r - x) * (r + x), other = (around - (b + x)) * (around + (b + x));
          return std::numbers::pi_v<long double> * std::max(0.0L, std::min(own, other));
        };
        const long double meet = (static_cast<long double>(around) * around - b * b - r * r) / (2.0L * b);
        const double low = std::max(-r, -b - around), high = std::min(r, around - b);
        const auto expected = static_cast<double>(pieces(section, low, high, {meet}));
        EXPECT_NEAR(volume_in_sphere(r, b, around), expected, promised * r * r * r) << r << ' ' << around << ' ' << b;
      }
    }
  }
  EXPECT_EQ(volume_in_sphere(0.5, 0.2, 1.0), volume(3, 0.5));
  EXPECT_EQ(volume_in_sphere(1.0, 0.2, 0.5), volume(3, 0.5));
  EXPECT_EQ(volume_in_sphere(0.5, 1.5, 1.0), 0.0);
}

/// Sections of constant x: a disc cut by the strip of the cylinder, and by the planes.
long double slow_cylinder(long double r, long double b, long double around, double low, double high) {
  const long double z0 = std::clamp(static_cast<long double>(low), -r, r);
  const long double z1 = std::clamp(static_cast<long double>(high), -r, r);
  const long double from = std::max(-r, -b - around), to = std::min(r, around - b);
  if (!(z0 < z1 && from < to)) return 0.0L;
  const auto strip = [&](long double x) {
    const long double square = std::max(0.0L, (r - x) * (r + x));
    const long double half = std::sqrt(std::max(0.0L, (around - b - x) * (around + b + x)));
    const long double side = std::min(half, std::sqrt(square));
    const auto height = [&](long double y) {
      const long double h = std::sqrt(std::max(0.0L, square - y * y));
      return std::max(0.0L, std::min(z1, h) - std::max(z0, -h));
    };
    std::vector<long double> corners;
    for (const long double z : {z0, z1}) note(corners, square - z * z);
    return side > 0.0L ? pieces(height, -side, side, corners) : 0.0L;
  };
  // Where the strip is as wide as the disc, all of it or its part at a plane.
  std::vector<long double> turns;
  for (const long double z : {0.0L, z0, z1}) {
    note(turns, r * r - z * z);
    if (b > 0.0L) turns.push_back((around * around - b * b - r * r + z * z) / (2.0L * b));
  }
  return pieces(strip, from, to, turns);
}

TEST(VolumeInCylinder, EqualsAnIntegralOfHeights) {
  std::mt19937_64 engine(13);
  const auto dice = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1p-53);
  };
  for (int k = 0; k < 60; ++k) {
    const double r = dice(0.5, 2.0), around = dice(0.1, 20.0);
    const double b = std::abs(around + dice(-1.0, 1.0) * r);
    const bool cut = k % 2 == 0;
    const double low = cut ? dice(-r, 0.9 * r) : -infinity, high = cut ? dice(low + 0.01, 1.2 * r) : infinity;
    const auto expected = static_cast<double>(slow_cylinder(r, b, around, low, high));
    EXPECT_NEAR(volume_in_cylinder(r, b, around, low, high), expected, promised * r * r * r)
        << r << ' ' << b << ' ' << around << ' ' << low << ' ' << high;
  }
}

}  // namespace
}  // namespace packmpi::geometry
