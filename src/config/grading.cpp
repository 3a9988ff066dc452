#include "config/grading.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"

namespace packmpi::input {
namespace {

/// Where the curve has the value `percent`.
double diameter_at(const Curve& curve, Interpolation interpolation, double percent) {
  const auto above = std::ranges::lower_bound(curve, percent, {}, [](const auto& point) { return point[1]; });
  if (above == curve.begin()) return (*above)[0];
  const auto& [low, p] = *(above - 1);
  const auto& [high, q] = *above;
  if (percent == q) return high;
  const double share = (percent - p) / (q - p);
  if (interpolation == Interpolation::linear) return low + share * (high - low);
  return std::clamp(low * elementary::power(high / low, share), low, high);
}

}  // namespace

std::string flaw(const Curve& curve, const std::array<double, 2>& keep_percent) {
  if (curve.size() < 2)
    return fmt::format("has {} point{}; give two at least", curve.size(), curve.size() == 1 ? "" : "s");
  for (std::size_t k = 1; k < curve.size(); ++k) {
    const auto& [low, p] = curve[k - 1];
    const auto& [high, q] = curve[k];
    if (low == high) return fmt::format("the diameter {:g} m is there twice; remove one", high);
    if (p > q)
      return fmt::format("has {1:g} percent at {2:g} m and {0:g} at {3:g} m; what passes a wider sieve cannot be less",
                         q, p, low, high);
  }
  if (curve.front()[1] > keep_percent[0]) {
    return fmt::format(
        "begins at {0:g} percent; begin with the diameter that nothing passes, 0 percent, or leave the finest out: "
        "keep_percent = [{1:g}, {2:g}]",
        curve.front()[1], std::ceil(100.0 * curve.front()[1]) / 100.0, keep_percent[1]);
  }
  if (curve.back()[1] < keep_percent[1]) {
    return fmt::format(
        "ends at {0:g} percent; end with the diameter that all pass, 100 percent, or leave the coarsest out: "
        "keep_percent = [{1:g}, {2:g}]",
        curve.back()[1], keep_percent[0], std::floor(100.0 * curve.back()[1]) / 100.0);
  }
  return "";
}

Curve kept_curve(const Radius& radius) {
  const double from = radius.keep_percent[0], to = radius.keep_percent[1];
  if (from == 0.0 && to == 100.0) return radius.diameter_curve;
  const auto rescaled = [&](double percent) { return 100.0 * ((percent - from) / (to - from)); };
  Curve kept{{diameter_at(radius.diameter_curve, radius.interpolation, from), 0.0}};
  for (const auto& [diameter, percent] : radius.diameter_curve) {
    if (percent > from && percent < to && diameter > kept.back()[0]) kept.push_back({diameter, rescaled(percent)});
  }
  const double end = diameter_at(radius.diameter_curve, radius.interpolation, to);
  if (end > kept.back()[0]) {
    kept.push_back({end, 100.0});
  } else {
    kept.back()[1] = 100.0;
  }
  return kept;
}

}  // namespace packmpi::input
