#include "base/elementary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace packmpi::elementary {
namespace {

double off(double got, double exact) { return std::abs(got - exact) / std::abs(exact); }

TEST(Elementary, AgreesWithTheLibraryToAFewLastBits) {
  double worst_log = 0.0, worst_exp = 0.0, worst_root = 0.0, worst_fifth = 0.0;
  for (int k = -3000; k <= 3000; ++k) {
    const double x = std::pow(1.2345, k / 10.0) * (1.0 + 1e-7 * k);
    if (std::abs(std::log(x)) > 1e-3) worst_log = std::max(worst_log, off(logarithm(x), std::log(x)));
    worst_root = std::max(worst_root, off(cube_root(x), std::cbrt(x)));
    const double fifth = fifth_root(x);
    worst_fifth = std::max(worst_fifth, off(fifth * fifth * fifth * fifth * fifth, x));
    const double y = 0.2 * k + 1e-5 * k;
    worst_exp = std::max(worst_exp, off(exponential(y), std::exp(y)));
  }
  EXPECT_LT(worst_log, 1e-15);
  EXPECT_LT(worst_root, 1e-15);
  EXPECT_LT(worst_exp, 1e-15);
  EXPECT_LT(worst_fifth, 2e-15);  // five times the root's
}

// Against long doubles, so that the library's own last bits do not count.
TEST(Elementary, CirclesAndTheErrorFunctionToAFewLastBits) {
  double worst_sine = 0.0, worst_arcsine = 0.0, worst_error = 0.0;
  for (int k = 1; k < 20000; ++k) {
    const double x = std::numbers::pi * k / 20000.0;
    worst_sine = std::max(worst_sine, off(sine(x), static_cast<double>(std::sin(static_cast<long double>(x)))));
    const double y = k / 20000.0;
    worst_arcsine =
        std::max(worst_arcsine, off(arcsine(y), static_cast<double>(std::asin(static_cast<long double>(y)))));
    const double z = (k - 10000) / 1500.0;  // -6.67 .. 6.67; e^(-z^2) amplifies the rounding of z^2
    const auto exact = static_cast<double>(std::erfc(static_cast<long double>(z)));
    worst_error = std::max(worst_error, off(complementary_error(z), exact) / (1.0 + z * z));
  }
  EXPECT_LT(worst_sine, 5e-16);
  EXPECT_LT(worst_arcsine, 1e-15);
  EXPECT_LT(worst_error, 3e-15);
  for (const double tiny : {1e-300, 1e-20, 1e-9}) {
    EXPECT_EQ(sine(tiny), tiny);
    EXPECT_DOUBLE_EQ(arcsine(tiny), tiny);
  }
  EXPECT_NEAR(sine(std::numbers::pi), 1.2246467991473532e-16, 1e-30);
  EXPECT_EQ(sine(0.0), 0.0);
  EXPECT_EQ(arcsine(0.0), 0.0);
  EXPECT_DOUBLE_EQ(arcsine(1.0), 0.5 * std::numbers::pi);
  EXPECT_EQ(complementary_error(0.0), 1.0);
  EXPECT_EQ(complementary_error(40.0), 0.0);
  EXPECT_EQ(complementary_error(-40.0), 2.0);
}

TEST(Elementary, CosineOfAQuarterTurn) {
  for (int k = 0; k <= 1000; ++k) {
    const double x = k * (0.5e-3 * std::numbers::pi);
    EXPECT_NEAR(cosine(x), std::cos(x), 5e-16);
  }
}

TEST(Elementary, ExactValues) {
  EXPECT_EQ(logarithm(1.0), 0.0);
  EXPECT_EQ(exponential(0.0), 1.0);
  EXPECT_EQ(exponential(-1000.0), 0.0);
  EXPECT_EQ(exponential(1000.0), std::numeric_limits<double>::infinity());
  for (const double x : {0.001, 0.5, 3.0, 7.0, 1e10}) EXPECT_NEAR(cube_root(x * x * x) / x, 1.0, 3e-16);
  EXPECT_EQ(power(1.0, 0.3), 1.0);
  EXPECT_EQ(power(0.37, 0.0), 1.0);
  EXPECT_NEAR(power(0.4, 0.35), std::pow(0.4, 0.35), 1e-15);
  EXPECT_NEAR(power(1e6, -1.5) / 1e-9, 1.0, 1e-14);
  for (const double x : {1.0, 32.0, 1.0 / 1024.0}) EXPECT_EQ(fifth_root(x * x * x * x * x), x);
}

}  // namespace
}  // namespace packmpi::elementary
