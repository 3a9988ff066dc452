#include "base/elementary.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace packmpi::elementary {

double logarithm(double x) noexcept {
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);
  if (mantissa < 0.5 * std::numbers::sqrt2) {
    mantissa *= 2.0;
    --exponent;
  }
  const double s = (mantissa - 1.0) / (mantissa + 1.0);  // |s| < 0.172: ln m = 2 (s + s^3/3 + s^5/5 + ...)
  double series = 1.0 / 23.0;
  for (int k = 21; k >= 1; k -= 2) series = series * (s * s) + 1.0 / k;
  return 2.0 * s * series + exponent * std::numbers::ln2;
}

double exponential(double x) noexcept {
  if (x < -745.0) return 0.0;
  if (x > 709.0) return std::numeric_limits<double>::infinity();
  constexpr double ln2_high = 0x1.62e42fee00000p-1;  // 20 bits short, so that its small multiples are exact
  constexpr double ln2_low = 0x1.a39ef35793c76p-33;
  const double k = std::floor(x / std::numbers::ln2 + 0.5);
  const double r = (x - k * ln2_high) - k * ln2_low;  // |r| < 0.35
  double series = 1.0;
  for (int n = 14; n >= 1; --n) series = 1.0 + series * r / n;
  return std::ldexp(series, static_cast<int>(k));
}

double power(double base, double exponent) noexcept { return exponential(exponent * logarithm(base)); }

double cube_root(double x) noexcept {
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);  // [0.5, 1)
  while (exponent % 3 != 0) {
    mantissa *= 0.5;
    ++exponent;
  }
  double root = 0.4 + 0.6 * mantissa;  // mantissa in [0.125, 1): within 5 %
  for (int k = 0; k < 5; ++k) root -= (root * root * root - mantissa) / (3.0 * root * root);
  return std::ldexp(root, exponent / 3);
}

double fifth_root(double x) noexcept {
  int exponent = 0;
  double mantissa = std::frexp(x, &exponent);  // [0.5, 1)
  while (exponent % 5 != 0) {
    mantissa *= 0.5;
    ++exponent;
  }
  double root = 0.6 + 0.4 * mantissa;  // mantissa in [1/32, 1): within 23 %
  for (int k = 0; k < 7; ++k) {
    const double fourth = (root * root) * (root * root);
    root -= (fourth * root - mantissa) / (5.0 * fourth);
  }
  return std::ldexp(root, exponent / 5);
}

}  // namespace packmpi::elementary
