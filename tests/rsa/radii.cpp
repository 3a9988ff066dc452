// The size distributions against their exact moments and distribution functions.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "rsa/insert.hpp"
#include "scene/expectation.hpp"
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

using input::SizeDistribution;
using input::Weighting;

// F(r) by number, given a distribution function M by mass, by fine quadrature: dF ~ dM / r^3.
std::function<double(double)> by_number(const std::function<double(double)>& mass, double min, double max) {
  constexpr int steps = 200000;
  std::vector<double> below{0.0};
  const auto at = [=](int k) { return min * std::pow(max / min, static_cast<double>(k) / steps); };
  for (int k = 0; k < steps; ++k) {
    const double r = std::sqrt(at(k) * at(k + 1));
    below.push_back(below.back() + (mass(at(k + 1)) - mass(at(k))) / (r * r * r));
  }
  return [=](double r) {
    const double k = std::clamp(std::log(r / min) / std::log(max / min), 0.0, 1.0) * steps;
    return below[static_cast<std::size_t>(k)] / below.back();
  };
}

// Draws against F by number; the curve's passing shares and quantiles against F and M.
void expect_curve(const input::Radius& radius, const std::function<double(double)>& given) {
  const scene::Sizes sizes(radius, 42);
  const double min = sizes.smallest();
  const double max = sizes.largest();
  const bool mass = radius.weighting == Weighting::mass;
  const auto number = mass ? by_number(given, min, max) : given;
  std::vector<double> r(draws);
  double sum = 0.0;
  for (int k = 0; k < draws; ++k) {
    const double x = sizes.draw(3, static_cast<std::uint64_t>(k));
    ASSERT_GE(x, min);
    ASSERT_LE(x, max);
    r[static_cast<std::size_t>(k)] = x;
    sum += x;
  }
  std::ranges::sort(r);
  double distance = 0.0;
  for (int k = 0; k < draws; ++k) {
    distance = std::max(distance, std::abs((k + 0.5) / draws - number(r[static_cast<std::size_t>(k)])));
  }
  EXPECT_LT(distance, 1.95 / std::sqrt(draws) + 2e-5);
  const double mean = sizes.curve().moment(1);
  const double sd = std::sqrt(sizes.curve().moment(2) - mean * mean);
  EXPECT_NEAR(sum / draws, mean, 4.0 * sd / std::sqrt(draws));
  for (const double share : {0.01, 0.1, 0.3, 0.5, 0.6, 0.9, 0.999}) {
    const double q = sizes.curve().quantile(radius.weighting, share);
    EXPECT_NEAR(given(q), share, 2e-5) << "at " << share;
    EXPECT_NEAR(sizes.curve().passing(radius.weighting, q), share, 1e-12);
    const double by_count = sizes.curve().quantile(Weighting::number, share);
    EXPECT_NEAR(number(by_count), share, 5e-5);
  }
  EXPECT_EQ(sizes.curve().passing(Weighting::mass, 0.99 * min), 0.0);
  EXPECT_EQ(sizes.curve().passing(Weighting::mass, max), 1.0);
}

input::Radius truncated_radius(SizeDistribution kind, Weighting weighting, double min, double max) {
  input::Radius radius = uniform_radius(min, max);
  radius.distribution = kind;
  radius.weighting = weighting;
  return radius;
}

std::function<double(double)> cut(const std::function<double(double)>& whole, double a, double b) {
  return [=](double r) { return (whole(r) - whole(a)) / (whole(b) - whole(a)); };
}

TEST(Radii, Lognormal) {
  for (const Weighting weighting : {Weighting::number, Weighting::mass}) {
    input::Radius radius = truncated_radius(SizeDistribution::lognormal, weighting, 0.004, 0.05);
    radius.median = 0.015;
    radius.log_sd = 0.5;
    expect_curve(radius, cut([](double r) { return phi(std::log(r / 0.015) / 0.5); }, 0.004, 0.05));
  }
}

TEST(Radii, Weibull) {
  for (const Weighting weighting : {Weighting::number, Weighting::mass}) {
    for (const double shape : {0.8, 2.5}) {
      input::Radius radius = truncated_radius(SizeDistribution::weibull, weighting, 0.002, 0.04);
      radius.scale = 0.015;
      radius.shape = shape;
      expect_curve(radius, cut([shape](double r) { return 1.0 - std::exp(-std::pow(r / 0.015, shape)); }, 0.002, 0.04));
    }
  }
}

// The number density of shares by area is that of the distribution over r^2.
TEST(Radii, ByAreaAsASectionHasThem) {
  const auto distance = [](const input::Radius& radius, const std::function<double(double)>& number) {
    const scene::Sizes sizes(radius, 42);
    std::vector<double> r;
    for (int k = 0; k < draws; ++k) r.push_back(sizes.draw(0, static_cast<std::uint64_t>(k)));
    std::ranges::sort(r);
    double most = 0.0;
    for (int k = 0; k < draws; ++k)
      most = std::max(most, std::abs((k + 0.5) / draws - number(r[static_cast<std::size_t>(k)])));
    return most;
  };
  const double a = 0.001, b = 0.02, noise = 1.95 / std::sqrt(draws);
  const input::Radius uniform = truncated_radius(SizeDistribution::uniform, Weighting::area, a, b);
  EXPECT_LT(distance(uniform, [=](double r) { return (1.0 / a - 1.0 / r) / (1.0 / a - 1.0 / b); }), noise);
  input::Radius curve = uniform;
  curve.distribution = SizeDistribution::grading;
  curve.diameter_curve = {{2.0 * a, 0.0}, {2.0 * b, 100.0}};
  EXPECT_LT(distance(curve, [=](double r) { return (1 / (a * a) - 1 / (r * r)) / (1 / (a * a) - 1 / (b * b)); }),
            noise);
  input::Radius two = uniform;
  two.distribution = SizeDistribution::discrete;
  two.radii = {0.001, 0.002};
  two.shares = {1.0, 1.0};
  EXPECT_NEAR(scene::SizeCurve(two).passing(Weighting::number, 0.001), 0.8, 1e-15);
  EXPECT_NEAR(scene::SizeCurve(two).passing(Weighting::mass, 0.001), 1.0 / 3.0, 1e-15);
}

TEST(Radii, GaussianAndUniformByMass) {
  input::Radius radius = truncated_radius(SizeDistribution::gaussian, Weighting::mass, 0.01, 0.03);
  radius.mean = 0.02;
  radius.sd = 0.004;
  expect_curve(radius, cut([](double r) { return phi((r - 0.02) / 0.004); }, 0.01, 0.03));
  expect_curve(truncated_radius(SizeDistribution::uniform, Weighting::mass, 0.001, 0.02),
               [](double r) { return (r - 0.001) / 0.019; });
}

// Between the points the share is linear in the diameter or in its logarithm; the middle piece is a gap.
TEST(Radii, Grading) {
  const std::vector<std::pair<double, double>> points{{0.001, 0.0}, {0.004, 0.3}, {0.008, 0.3}, {0.02, 1.0}};  // radii
  for (const Weighting weighting : {Weighting::number, Weighting::mass}) {
    for (const auto interpolation : {input::Interpolation::linear, input::Interpolation::log}) {
      input::Radius radius;
      radius.distribution = SizeDistribution::grading;
      radius.weighting = weighting;
      radius.interpolation = interpolation;
      for (const auto& [r, share] : points) radius.diameter_curve.push_back({2.0 * r, 100.0 * share});
      expect_curve(radius, [=](double r) {
        std::size_t k = 1;
        while (k + 1 < points.size() && points[k].first < r) ++k;
        const auto [a, p] = points[k - 1];
        const auto [b, q] = points[k];
        const bool log = interpolation == input::Interpolation::log;
        return p + (q - p) * (log ? std::log(r / a) / std::log(b / a) : (r - a) / (b - a));
      });
    }
  }
}

TEST(Radii, ClassesHaveTheirShares) {
  input::Radius radius;
  radius.distribution = SizeDistribution::discrete;
  radius.weighting = Weighting::mass;
  radius.radii = {0.001, 0.002, 0.004};
  radius.shares = {1.0, 2.0, 1.0};
  const scene::Sizes sizes(radius, 42);
  std::array<int, 3> count{};
  for (int k = 0; k < draws; ++k) {
    const double r = sizes.draw(0, static_cast<std::uint64_t>(k));
    ++count.at(r == 0.001 ? 0 : r == 0.002 ? 1 : 2);
  }
  const std::array<double, 3> weights{1.0, 2.0 / 8.0, 1.0 / 64.0};  // mass / r^3
  for (std::size_t k = 0; k < 3; ++k) {
    const double share = weights.at(k) / (weights[0] + weights[1] + weights[2]);
    EXPECT_NEAR(count.at(k), draws * share, 4.0 * std::sqrt(draws * share * (1.0 - share)));
  }
  EXPECT_EQ(sizes.curve().quantile(Weighting::mass, 0.5), 0.002);
  EXPECT_EQ(sizes.curve().quantile(Weighting::number, 0.5), 0.001);
  EXPECT_NEAR(sizes.curve().passing(Weighting::mass, 0.002), 0.75, 1e-15);
  EXPECT_NEAR(sizes.curve().passing(Weighting::mass, 0.00199), 0.25, 1e-15);
}

TEST(Radii, BidisperseIsTwoClasses) {
  input::Radius radius;
  radius.distribution = SizeDistribution::bidisperse;
  radius.weighting = Weighting::mass;
  radius.small = 0.001;
  radius.large = 0.02;
  radius.large_share = 0.7;
  const scene::Sizes sizes(radius, 1);
  EXPECT_EQ(sizes.smallest(), 0.001);
  EXPECT_EQ(sizes.largest(), 0.02);
  EXPECT_NEAR(sizes.curve().passing(Weighting::mass, 0.01), 0.3, 1e-15);
  EXPECT_NEAR(sizes.curve().passing(Weighting::number, 0.01), 0.3 / (0.3 + 0.7 / 8000.0), 1e-15);
}

// Elementary functions of our own: the last bit of these radii must be the same on every machine.
TEST(Radii, BitsAreFixed) {
  input::Radius radius = truncated_radius(SizeDistribution::lognormal, Weighting::mass, 0.004, 0.05);
  radius.median = 0.015;
  radius.log_sd = 0.5;
  EXPECT_EQ(scene::Sizes(radius, 42).draw(3, 7), 0x1.11ae3f53a90b9p-7);
  radius = {};
  radius.distribution = SizeDistribution::grading;
  radius.weighting = Weighting::mass;
  radius.diameter_curve = {{0.002, 0.0}, {0.01, 40.0}, {0.04, 100.0}};
  EXPECT_EQ(scene::Sizes(radius, 42).draw(3, 7), 0x1.30819a44c524p-9);
  radius.weighting = Weighting::number;
  EXPECT_EQ(scene::Sizes(radius, 42).draw(3, 7), 0x1.286aa9da36a6fp-6);
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

TEST(Radii, ClassesOfAWideRangeHaveEqualRatios) {
  const scene::Sizes sizes(uniform_radius(0.001, 0.256), 1);  // a factor of two a class
  EXPECT_EQ(rsa::size_class(sizes, 0.256), 0);
  EXPECT_EQ(rsa::size_class(sizes, 0.129), 0);
  EXPECT_EQ(rsa::size_class(sizes, 0.127), 1);
  EXPECT_EQ(rsa::size_class(sizes, 0.0039), 6);
  EXPECT_EQ(rsa::size_class(sizes, 0.001), 7);
}

TEST(Radii, ArePureFunctionsOfTheirNames) {
  const input::Radius radius = gaussian_radius(0.02, 0.002, 0.014, 0.026);
  const scene::Sizes sizes(radius, 42);
  EXPECT_EQ(sizes.draw(1, 10), scene::Sizes(radius, 42).draw(1, 10));
  EXPECT_NE(sizes.draw(1, 10), sizes.draw(1, 11));
  EXPECT_NE(sizes.draw(1, 10), sizes.draw(2, 10));
  EXPECT_NE(sizes.draw(1, 10), scene::Sizes(radius, 43).draw(1, 10));
}

// Radii are drawn until their volume fills the layer: mean and deviation of their number over many layers.
TEST(Radii, AsManyAsAreExpectedFillALayer) {
  const comm::Comm comm(MPI_COMM_SELF);
  scene::Scene scene = test::rsa_scene(3, {1.0, 1.0, 1.0}, {true, true}, uniform_radius(0.01, 0.05), 0.2, 100);
  scene.in.layers.thickness = 0.2;
  constexpr int layers = 2000;
  double sum = 0.0, squares = 0.0;
  const double expected = static_cast<double>(scene::particles_a_layer(scene));
  const double deviation = scene::deviation_of_count(scene, expected);
  for (std::uint32_t layer = 0; layer < layers; ++layer) {
    const rsa::LayerRegion region{.layer = layer, .bottom = 0.0, .thickness = scene.in.layers.thickness};
    const double off = static_cast<double>(rsa::particles_needed(comm, scene, region)) - expected;
    sum += off;
    squares += off * off;
  }
  EXPECT_NEAR(sum / layers, 0.0, 0.5 + 4.0 * deviation / std::sqrt(layers));  // the expectation is a whole number
  EXPECT_NEAR(std::sqrt(squares / layers), deviation, 0.1 * deviation);
  EXPECT_GT(deviation, 5.0);
}

}  // namespace
}  // namespace packmpi
