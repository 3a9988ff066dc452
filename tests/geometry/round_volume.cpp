// Spheres cut by cylinders, against closed forms and a slow sum over points; places drawn in a cylinder.
#include "geometry/round_volume.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "geometry/container.hpp"
#include "geometry/volume.hpp"

namespace packmpi::geometry {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double infinity = HUGE_VAL;
constexpr double promised = 1e-9;  // of r^3

TEST(VolumeInCylinder, HasTheKnownForms) {
  const double r = 0.7;
  const double whole = volume(3, r);
  EXPECT_EQ(volume_in_cylinder(r, 0.2, 2.0, -infinity, infinity), whole);
  EXPECT_EQ(volume_in_cylinder(r, 5.0, 2.0, -infinity, infinity), 0.0);
  EXPECT_EQ(volume_in_cylinder(r, 0.2, 0.0, -infinity, infinity), 0.0);
  for (const double c : {0.1, 0.5, 0.69}) {  // around the same axis: what a drill takes out
    const double expected = 4.0 / 3.0 * pi * (r * r * r - std::pow(r * r - c * c, 1.5));
    EXPECT_NEAR(volume_in_cylinder(r, 0.0, c, -infinity, infinity), expected, promised * r * r * r) << c;
  }
  // Viviani: a cylinder of half the radius that touches the axis of the sphere.
  EXPECT_NEAR(volume_in_cylinder(r, 0.5 * r, 0.5 * r, -infinity, infinity), (2.0 * pi / 3.0 - 8.0 / 9.0) * r * r * r,
              promised * r * r * r);
  // A wide cylinder is a plane.
  EXPECT_NEAR(volume_in_cylinder(r, 1e9 - 0.3, 1e9, -infinity, infinity), volume_below(3, r, 0.0, 0.3), 1e-6);
}

/// By thin slices between which the section is a lens, by the textbook's formula.
double slow(double r, double b, double cylinder, double low, double high) {
  const auto lens = [&](double s) {
    if (b + s <= cylinder) return pi * s * s;
    if (b + cylinder <= s) return pi * cylinder * cylinder;
    if (b >= s + cylinder) return 0.0;
    const double first = std::acos(std::clamp((b * b + s * s - cylinder * cylinder) / (2.0 * b * s), -1.0, 1.0));
    const double second =
        std::acos(std::clamp((b * b + cylinder * cylinder - s * s) / (2.0 * b * cylinder), -1.0, 1.0));
    return s * s * (first - 0.5 * std::sin(2.0 * first)) +
           cylinder * cylinder * (second - 0.5 * std::sin(2.0 * second));
  };
  constexpr int slices = 20000;
  const double from = std::max(low, -r), to = std::min(high, r);
  double sum = 0.0;
  for (int k = 0; k < slices; ++k) {
    const double z = from + (to - from) * (k + 0.5) / slices;
    sum += lens(std::sqrt(r * r - z * z));
  }
  return sum * (to - from) / slices;
}

TEST(VolumeInCylinder, EqualsASlowSum) {
  std::mt19937_64 engine(7);
  const auto dice = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(engine() >> 11) * 0x1p-53);
  };
  for (int k = 0; k < 300; ++k) {
    const double r = dice(0.5, 2.0), cylinder = dice(0.1, 20.0);
    const double b = std::abs(cylinder + dice(-1.1, 1.1) * r);
    const bool cut = k % 2 == 0;
    const double low = cut ? dice(-r, r) : -infinity, high = cut ? dice(low, 1.2 * r) : infinity;
    EXPECT_NEAR(volume_in_cylinder(r, b, cylinder, low, high), slow(r, b, cylinder, low, high), 2e-6 * r * r * r)
        << r << ' ' << b << ' ' << cylinder << ' ' << low << ' ' << high;
  }
}

TEST(VolumeInCylinder, AddsUpAndRises) {
  const double r = 1.0;
  for (const double b : {0.0, 1e-9, 0.3, 1.0, 3.0, 40.0}) {
    double last = 0.0;
    for (int k = 0; k <= 400; ++k) {
      const double cylinder = std::max(0.0, b - r) + k * 0.005;
      const double whole = volume_in_cylinder(r, b, cylinder, -infinity, infinity);
      EXPECT_GE(whole, last - promised);
      const double parts = volume_in_cylinder(r, b, cylinder, -infinity, -0.2) +
                           volume_in_cylinder(r, b, cylinder, -0.2, 0.7) +
                           volume_in_cylinder(r, b, cylinder, 0.7, infinity);
      EXPECT_NEAR(parts, whole, 2.0 * promised) << b << ' ' << cylinder;
      last = whole;
    }
    EXPECT_NEAR(volume_in_cylinder(r, b, b + r, -infinity, infinity), volume(3, r), promised);
  }
}

Container cylinder(double diameter, double height) {
  Container vessel;
  vessel.size = {diameter, diameter, height};
  vessel.shape = Shape::cylinder;
  return vessel;
}

TEST(Cylinder, HasOneRoundWallAndAFloor) {
  const Container vessel = cylinder(2.0, 3.0);
  EXPECT_DOUBLE_EQ(vessel.mean_area(), pi);
  EXPECT_DOUBLE_EQ(vessel.volume_between(1.0, 3.0), 2.0 * pi);
  EXPECT_DOUBLE_EQ(vessel.wall_area(3.0), 6.0 * pi);
  EXPECT_TRUE(vessel.has(Surface::floor));
  EXPECT_TRUE(vessel.has(Surface::mantle));
  for (const Surface plane : {Surface::x_low, Surface::x_high, Surface::y_low, Surface::y_high}) {
    EXPECT_FALSE(vessel.has(plane));
  }
  const Facing at = vessel.facing(Surface::mantle, {1.6, 1.8, 0.3});  // (0.6, 0.8) from the axis: on the wall
  EXPECT_NEAR(at.distance, 0.0, 1e-15);
  EXPECT_NEAR(at.normal[0], 0.6, 1e-15);
  EXPECT_NEAR(at.normal[1], 0.8, 1e-15);
  EXPECT_EQ(at.normal[2], 0.0);
  EXPECT_EQ(vessel.facing(Surface::mantle, {1.0, 1.0, 0.0}).normal, Vec3{});  // on the axis
  EXPECT_NEAR(vessel.beyond({1.6, 1.9, 0.3}), std::hypot(0.6, 0.9) - 1.0, 1e-15);
  EXPECT_NEAR(vessel.beyond({1.0, 1.0, -0.25}), 0.25, 1e-15);
  EXPECT_TRUE(std::isnan(vessel.beyond({std::nan(""), 1.0, 0.5})));
  EXPECT_FALSE(Container{}.has(Surface::mantle));
}

/// As many in each of sixteen equal parts of the disc: four rings by four quarters.
TEST(Cylinder, PlacesAreDrawnEvenly) {
  const Container vessel = cylinder(2.0, 1.0);
  const double radius = 0.1, reach = 0.9;
  std::array<int, 16> counts{};
  constexpr int side = 200;
  for (int i = 0; i < side; ++i) {
    for (int k = 0; k < side; ++k) {
      const Vec3 x = vessel.draw({(i + 0.5) / side, (k + 0.5) / side, 0.0}, radius, 0.0, 1.0);
      const double a = x[0] - 1.0, b = x[1] - 1.0;
      const double share = (a * a + b * b) / (reach * reach);
      ASSERT_LE(share, 1.0 + 1e-12);
      const auto ring = static_cast<std::size_t>(std::min(3.0, 4.0 * share));
      ++counts.at(4 * ring + (a > 0.0 ? 1U : 0U) + (b > 0.0 ? 2U : 0U));
    }
  }
  for (const int count : counts) EXPECT_EQ(count, side * side / 16);
}

}  // namespace
}  // namespace packmpi::geometry
