// The size distributions against their exact moments and distribution functions.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "rsa/insert.hpp"
#include "support/rsa_scenes.hpp"

namespace packmpi {
namespace {

using test::equal_radius;
using test::gaussian_radius;
using test::uniform_radius;

constexpr int draws = 200000;

double phi(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }
double density(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2.0 * std::numbers::pi); }

struct Moments {
  double mean, sd;
};

// Of a normal (m, s) cut to [a, b].
Moments truncated(double m, double s, double a, double b) {
  const double low = (a - m) / s;
  const double high = (b - m) / s;
  const double inside = phi(high) - phi(low);
  const double shift = (density(low) - density(high)) / inside;
  const double variance = 1.0 + (low * density(low) - high * density(high)) / inside - shift * shift;
  return {m + s * shift, s * std::sqrt(variance)};
}

// Mean, sd and largest distance of the distribution functions (Kolmogorov) within four standard errors.
void expect_distribution(const input::Radius& radius, const Moments& exact,
                         const std::function<double(double)>& distribution) {
  const scene::Sizes sizes(radius, 42);
  std::vector<double> r(draws);
  double sum = 0.0, squares = 0.0;
  for (int k = 0; k < draws; ++k) {
    const double x = sizes.draw(3, static_cast<std::uint64_t>(k));
    ASSERT_GE(x, sizes.smallest());
    ASSERT_LE(x, sizes.largest());
    r[static_cast<std::size_t>(k)] = x;
    sum += x;
    squares += (x - exact.mean) * (x - exact.mean);
  }
  EXPECT_NEAR(sum / draws, exact.mean, 4.0 * exact.sd / std::sqrt(draws));
  EXPECT_NEAR(std::sqrt(squares / draws), exact.sd, 4.0 * exact.sd / std::sqrt(2.0 * draws));
  EXPECT_NEAR(sizes.mean(), exact.mean, 1e-12 * exact.mean);
  std::ranges::sort(r);
  double distance = 0.0;
  for (int k = 0; k < draws; ++k) {
    distance = std::max(distance, std::abs((k + 0.5) / draws - distribution(r[static_cast<std::size_t>(k)])));
  }
  EXPECT_LT(distance, 1.95 / std::sqrt(draws));  // exceeded by chance once in a thousand
}

void expect_truncated(double m, double s, double a, double b) {
  SCOPED_TRACE(testing::Message() << "mean " << m << " sd " << s << " in [" << a << ", " << b << "]");
  const auto distribution = [=](double x) {
    return (phi((x - m) / s) - phi((a - m) / s)) / (phi((b - m) / s) - phi((a - m) / s));
  };
  expect_distribution(gaussian_radius(m, s, a, b), truncated(m, s, a, b), distribution);
}

TEST(Radii, GaussianAsInThePaper) { expect_truncated(0.02, 0.002, 0.014, 0.026); }
TEST(Radii, GaussianCutHard) { expect_truncated(0.02, 0.002, 0.0185, 0.023); }
TEST(Radii, GaussianNarrowWindow) { expect_truncated(0.02, 0.002, 0.0199, 0.0215); }
TEST(Radii, GaussianHalf) { expect_truncated(0.02, 0.002, 0.02, 0.028); }
TEST(Radii, GaussianTail) { expect_truncated(0.02, 0.002, 0.024, 0.029); }

TEST(Radii, Uniform) {
  expect_distribution(uniform_radius(0.01, 0.03), {0.02, 0.02 / std::sqrt(12.0)},
                      [](double x) { return (x - 0.01) / 0.02; });
}

TEST(Radii, EqualAndDegenerate) {
  EXPECT_EQ(scene::Sizes(equal_radius(0.013), 7).draw(2, 5), 0.013);
  EXPECT_EQ(scene::Sizes(gaussian_radius(0.02, 0.0, 0.01, 0.03), 7).draw(2, 5), 0.02);
  EXPECT_EQ(scene::Sizes(uniform_radius(0.02, 0.02), 7).draw(2, 5), 0.02);
}

TEST(Radii, ClassesFromTheLargestDown) {
  const scene::Sizes sizes(uniform_radius(0.01, 0.03), 1);
  EXPECT_EQ(rsa::size_class(sizes, 0.03), 0);
  EXPECT_EQ(rsa::size_class(sizes, 0.0274), 1);
  EXPECT_EQ(rsa::size_class(sizes, 0.0126), 6);
  EXPECT_EQ(rsa::size_class(sizes, 0.01), 7);
  EXPECT_EQ(rsa::size_class(scene::Sizes(equal_radius(0.02), 1), 0.02), 0);
}

TEST(Radii, ArePureFunctionsOfTheirNames) {
  const input::Radius radius = gaussian_radius(0.02, 0.002, 0.014, 0.026);
  const scene::Sizes sizes(radius, 42);
  EXPECT_EQ(sizes.draw(1, 10), scene::Sizes(radius, 42).draw(1, 10));
  EXPECT_NE(sizes.draw(1, 10), sizes.draw(1, 11));
  EXPECT_NE(sizes.draw(1, 10), sizes.draw(2, 10));
  EXPECT_NE(sizes.draw(1, 10), scene::Sizes(radius, 43).draw(1, 10));
}

}  // namespace
}  // namespace packmpi
