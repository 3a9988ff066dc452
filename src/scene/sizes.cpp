#include "scene/sizes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/elementary.hpp"
#include "base/random.hpp"

namespace packmpi::scene {
namespace {

constexpr std::uint32_t most_trials = 10000;  // acceptance is 0.3 or more for any sensible window

// Two numbers in (0, 1] and [0, 1).
std::pair<double, double> two_uniforms(const random::Name& name) {
  const auto [a, b] = random::words(name);
  return {static_cast<double>((a >> 11U) + 1U) * 0x1p-53, static_cast<double>(b >> 11U) * 0x1p-53};
}

// Kinderman and Monahan (1977): x = c (v - 1/2) / u is normal where x^2 <= -4 ln u. Knuth's two bounds save the
// logarithm.
bool normal_by_ratio(double u, double x) {
  const double squared = x * x;
  if (squared <= 5.0 - 5.136101666675097 * u) return true;   // 4 exp(1/4)
  if (squared >= 1.036961042583566 / u + 1.4) return false;  // 4 exp(-1.35)
  return squared <= -4.0 * elementary::logarithm(u);
}

// One trial for a normal deviate in [low, high]; true if `x` is one.
bool truncated_trial(const random::Name& name, double low, double high, double& x) {
  const auto [u, v] = two_uniforms(name);
  if (high - low >= 2.0 && low <= 0.0 && high >= 0.0) {
    x = 1.7155277699214135 * (v - 0.5) / u;  // sqrt(8 / e)
    return x >= low && x <= high && normal_by_ratio(u, x);
  }
  // A narrow or one-sided window would reject nearly all of these: propose inside it instead.
  x = low + v * (high - low);
  const double peak = std::clamp(0.0, low, high);
  return elementary::logarithm(u) <= 0.5 * (peak * peak - x * x);
}

double truncated_normal(const input::Radius& radius, random::Name name) {
  if (!(radius.sd > 0.0)) return std::clamp(radius.mean, radius.min, radius.max);
  const double low = (radius.min - radius.mean) / radius.sd;
  const double high = (radius.max - radius.mean) / radius.sd;
  for (; name.attempt < most_trials; ++name.attempt) {
    double x = 0.0;
    if (truncated_trial(name, low, high, x)) return std::clamp(radius.mean + radius.sd * x, radius.min, radius.max);
  }
  return std::clamp(radius.mean, radius.min, radius.max);  // probability below 1e-15 even 5 sd off the mean
}

// Shuffled by the seed (Fisher and Yates, backwards), or as it is.
std::vector<double> in_order(const input::Radius& radius, std::uint64_t seed) {
  std::vector<double> list = radius.radii;
  if (radius.order == input::ListOrder::file) return list;
  for (std::size_t k = list.size(); k > 1; --k) {
    const auto [a, b] = random::words({seed, random::Purpose::radius, 0, k, 0});
    std::swap(list[k - 1], list[(a ^ b) % k]);
  }
  return list;
}

}  // namespace

Sizes::Sizes(const input::Radius& radius, std::uint64_t seed)
    : radius_(radius), seed_(seed), curve_(std::make_shared<const SizeCurve>(radius)) {
  if (radius.distribution != input::SizeDistribution::list) return;
  list_ = std::make_shared<const std::vector<double>>(in_order(radius, seed));
  radius_.radii.clear();  // they are in list_
}

double Sizes::draw(std::uint32_t layer, std::uint64_t index, GlobalId first) const {
  if (list_) return (*list_)[std::min(static_cast<std::size_t>(first) + index, list_->size() - 1)];
  const random::Name name{seed_, random::Purpose::radius, layer, index, 0};
  if (equal()) return radius_.value;
  if (bounded() && radius_.distribution == input::SizeDistribution::gaussian) return truncated_normal(radius_, name);
  if (bounded()) return std::min(radius_.min + two_uniforms(name).second * (radius_.max - radius_.min), radius_.max);
  const auto u = random::uniforms(name);
  return curve_->draw(u[0], u[1]);
}

double Sizes::mean() const noexcept {
  if (equal()) return radius_.value;
  if (!bounded()) return curve_->moment(1);
  if (radius_.distribution == input::SizeDistribution::uniform) return 0.5 * (radius_.min + radius_.max);
  if (!(radius_.sd > 0.0)) return std::clamp(radius_.mean, radius_.min, radius_.max);
  const double low = (radius_.min - radius_.mean) / radius_.sd;
  const double high = (radius_.max - radius_.mean) / radius_.sd;
  const double density = (elementary::exponential(-0.5 * low * low) - elementary::exponential(-0.5 * high * high)) /
                         std::sqrt(2.0 * std::numbers::pi);
  const double inside = 0.5 * (elementary::complementary_error(-high / std::numbers::sqrt2) -
                               elementary::complementary_error(-low / std::numbers::sqrt2));
  return radius_.mean + radius_.sd * density / inside;
}

}  // namespace packmpi::scene
