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
  if (std::isnan(x)) return x;
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

double cosine(double x) noexcept {
  double series = 1.0;
  for (int n = 24; n >= 2; n -= 2) series = 1.0 - series * (x * x) / (n * (n - 1));
  return series;
}

double power(double base, double exponent) noexcept { return exponential(exponent * logarithm(base)); }

double sine(double x) noexcept {
  constexpr double pi_low = 0x1.1a62633145c07p-53;  // pi beyond the nearest double
  if (x > 0.5 * std::numbers::pi) x = (std::numbers::pi - x) + pi_low;
  const double square = x * x;
  double rest = 1.0;  // Horner from the 12th term of x (1 - x^2/(2 3) (1 - x^2/(4 5) (...)))
  for (int k = 12; k >= 1; --k) rest = 1.0 - square / (2.0 * k * (2.0 * k + 1.0)) * rest;
  return x * rest;
}

double arcsine(double x) noexcept {
  double t = x / (1.0 + std::sqrt((1.0 - x) * (1.0 + x)));  // of half the angle, at most pi / 4, the tangent
  for (int half = 0; half < 2; ++half) t /= 1.0 + std::sqrt(1.0 + t * t);
  double series = 1.0 / 25.0;  // t < 0.2: arctan t = t - t^3/3 + t^5/5 - ...
  for (int k = 23; k >= 1; k -= 2) series = 1.0 / k - t * t * series;
  return 8.0 * t * series;
}

// Of x in [0, 1) by the series of erf, whose terms are all positive; beyond by Laplace's continued fraction.
double complementary_error(double x) noexcept {
  if (x < 0.0) return 2.0 - complementary_error(-x);
  const double root_of_pi = std::sqrt(std::numbers::pi);
  if (x < 1.0) {
    double series = 1.0;  // erf x = 2 x e^(-x^2) / sqrt(pi) (1 + 2 x^2/3 (1 + 2 x^2/5 (...)))
    for (int k = 24; k >= 1; --k) series = 1.0 + 2.0 * (x * x) / (2.0 * k + 1.0) * series;
    return 1.0 - 2.0 * x * exponential(-x * x) / root_of_pi * series;
  }
  double fraction = x;
  for (int k = 200; k >= 1; --k) fraction = x + 0.5 * k / fraction;
  return exponential(-x * x) / (root_of_pi * fraction);
}

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
