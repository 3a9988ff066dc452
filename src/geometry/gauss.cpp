#include "geometry/gauss.hpp"

#include <numbers>

#include "base/elementary.hpp"

namespace packmpi::geometry {
namespace {

// The roots of the polynomial by Newton's steps from Tricomi's guess.
GaussRule make_rule() {
  GaussRule rule;
  constexpr std::size_t points = 24;
  constexpr int n = static_cast<int>(points);
  for (std::size_t k = 0; k < points / 2; ++k) {
    double x = elementary::cosine(std::numbers::pi * (static_cast<double>(k) + 0.75) / (n + 0.5));
    double slope = 1.0;
    for (int turn = 0; turn < 10; ++turn) {
      double last = 1.0, now = x;
      for (int m = 2; m <= n; ++m) {
        const double next = ((2.0 * m - 1.0) * x * now - (m - 1.0) * last) / m;
        last = now, now = next;
      }
      slope = n * (x * now - last) / (x * x - 1.0);
      x -= now / slope;
    }
    const double weight = 1.0 / ((1.0 - x * x) * slope * slope);  // half of it: the interval is [0, 1]
    rule.x.at(k) = 0.5 * (1.0 - x), rule.x.at(points - 1 - k) = 0.5 * (1.0 + x);
    rule.weight.at(k) = rule.weight.at(points - 1 - k) = weight;
  }
  return rule;
}

}  // namespace

const GaussRule& gauss_rule() noexcept {
  static const GaussRule rule = make_rule();
  return rule;
}

}  // namespace packmpi::geometry
