/// Integrals of smooth functions to rounding.
#pragma once
#include <array>
#include <cstddef>

namespace packmpi::geometry {

/// Gauss' and Legendre's rule of 24 points on [0, 1].
struct GaussRule {
  std::array<double, 24> x{}, weight{};
};
[[nodiscard]] const GaussRule& gauss_rule() noexcept;

/// Of f from low to high, where it is smooth but for both ends: there it may begin with a power of a half, which is
/// blended out.
template <class Function>
[[nodiscard]] double integral(const Function& f, double low, double high) {
  const GaussRule& rule = gauss_rule();
  double sum = 0.0;
  for (std::size_t k = 0; k < rule.x.size(); ++k) {
    const double u = rule.x[k];
    sum += rule.weight[k] * (6.0 * u * (1.0 - u)) * f(low + (high - low) * (u * u * (3.0 - 2.0 * u)));
  }
  return sum * (high - low);
}

}  // namespace packmpi::geometry
