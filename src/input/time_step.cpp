#include "input/time_step.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"

namespace packmpi::input {
namespace {

// A large particle that lands on a small one squeezes it q^(6/5) deeper than another small one would, q the ratio of
// radii, which makes the contact q^(3/10) stiffer in frequency; eq. (23) knows equal ones only.
double squeeze(const RadiusRange& radii) {
  const double q = radii.largest / radii.smallest;
  return q > alike_ratio ? elementary::power(q, 0.3) : 1.0;
}

// "stop" lets a slip end within one step: the larger the step, the more a bed creeps, and rough grains become denser
// by it than smooth ones (doc/theory.md, "Time step").
double chatter(const Contact& contact) {
  constexpr double smooth = 0.2;
  const double friction = std::max(contact.friction, contact.wall_friction);
  const bool stops = contact.tangential == Tangential::sliding && contact.regularisation == Regularisation::stop;
  return stops && friction > smooth ? std::sqrt(std::sqrt(friction / smooth)) : 1.0;
}

}  // namespace

double contact_duration(double reduced_mass, double reduced_radius, double reduced_modulus, double speed) {
  const double x = reduced_mass * reduced_mass / (reduced_radius * reduced_modulus * reduced_modulus * speed);
  return 2.87 * (std::isfinite(x) && x > 0.0 ? elementary::fifth_root(x) : x);
}

double impact_speed(const Input& in, double drop) {
  const double speed = norm(in.layers.velocity);
  return std::sqrt(2.0 * in.jamming.gravity * drop + speed * speed);
}

double step_limit(const Input& in, double radius, double youngs_modulus, double speed) {
  const double modulus = pair_modulus(in.particles, youngs_modulus);
  const double limit = contact_duration(0.5 * mass(in.particles, radius), 0.5 * radius, modulus, speed) / 5.0;
  // An explicit step dt of an oscillator is stable for omega dt < 2 (sqrt(xi^2 + 1) - xi): eq. (23) holds to xi = 1.
  const double xi = std::max(in.contact.damping_ratio, 1.0);
  return limit * ((std::sqrt(xi * xi + 1.0) - xi) / (std::sqrt(2.0) - 1.0));
}

double safe_step(const Input& in, const RadiusRange& radii, double youngs_modulus) {
  return step_limit(in, radii.smallest, youngs_modulus, impact_speed(in, in.layers.thickness)) / squeeze(radii);
}

double automatic_step(const Input& in, const RadiusRange& radii, double youngs_modulus) {
  const bool is_explicit = in.dynamics.theta == 0.0;
  return safe_step(in, radii, youngs_modulus) / (is_explicit ? chatter(in.contact) : 1.0);
}

}  // namespace packmpi::input
