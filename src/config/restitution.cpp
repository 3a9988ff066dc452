#include "config/restitution.hpp"

#include <cmath>
#include <numbers>

#include "base/elementary.hpp"

namespace packmpi::input {
namespace {

double share_of_critical() { return std::sqrt(1.2); }  // zeta / xi

// Where `falling`, a function that falls, has come down to `value` between low and high.
template <class Function>
double meeting(const Function& falling, double value, double low, double high) {
  constexpr int halvings = 60;
  for (int k = 0; k < halvings; ++k) {
    const double middle = 0.5 * (low + high);
    (falling(middle) > value ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double cotangent_times(double g) { return g * elementary::cosine(g) / elementary::sine(g); }

double minus_hyperbolic(double b) {
  if (b < 0.02) return -(1.0 + b * b / 3.0 - b * b * (b * b) / 45.0);  // 1 - fall would lose its digits
  const double fall = elementary::exponential(-2.0 * b);
  return -b * (1.0 + fall) / (1.0 - fall);
}

// zeta with the cut-off from half of -ln e.
double critical_share(double half_loss) {
  if (half_loss <= 1.0) {
    return elementary::cosine(meeting(cotangent_times, half_loss, 0.0, 0.5 * std::numbers::pi));
  }
  const double b = meeting(minus_hyperbolic, -half_loss, 0.0, half_loss);
  return 0.5 * (elementary::exponential(b) + elementary::exponential(-b));
}

// acos(zeta) / sqrt(1 - zeta^2), and acosh(zeta) / sqrt(zeta^2 - 1) beyond 1.
double angle_over_sine(double zeta) {
  const double x = 1.0 - zeta;
  if (std::abs(x) < 1e-3) {  // the quotients would lose their digits
    return 1.0 + x * (1.0 / 3.0 + x * (2.0 / 15.0 + x * (2.0 / 35.0 + x * (8.0 / 315.0))));
  }
  const double root = std::sqrt(std::abs(1.0 - zeta * zeta));
  const double angle =
      zeta < 1.0 ? 0.5 * std::numbers::pi - elementary::arcsine(zeta) : elementary::logarithm(zeta + root);
  return angle / root;
}

}  // namespace

double restitution_of(double damping_ratio, bool tension_cutoff) {
  const double zeta = share_of_critical() * damping_ratio;
  if (!tension_cutoff)
    return zeta < 1.0 ? elementary::exponential(-std::numbers::pi * zeta / std::sqrt(1.0 - zeta * zeta)) : 0.0;
  return elementary::exponential(-2.0 * zeta * angle_over_sine(zeta));
}

double damping_of(double restitution, bool tension_cutoff) {
  if (restitution == 1.0) return 0.0;
  const double loss = -elementary::logarithm(restitution);
  const double zeta =
      tension_cutoff ? critical_share(0.5 * loss) : loss / std::sqrt(std::numbers::pi * std::numbers::pi + loss * loss);
  return zeta / share_of_critical();
}

}  // namespace packmpi::input
