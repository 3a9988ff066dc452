#include "config/time_step.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/elementary.hpp"

namespace packmpi::input {
namespace {

// A large particle that lands on a small one squeezes it q^(6/5) deeper than another small one would, q the ratio of
// radii, which makes the contact q^(3/10) stiffer in frequency; eq. (23) knows equal ones only.
double squeeze(const RadiusRange& radii) {
  const double q = radii.largest / radii.smallest;
  return q > alike_ratio ? elementary::power(q, 0.3) : 1.0;
}

// What it bears for good: a force q^2 times that of a small one, so that it overlaps q^(4/3) as deep with twice the r*.
double press(const RadiusRange& radii) {
  const double q = radii.largest / radii.smallest;
  return q > alike_ratio ? elementary::power(2.0, 0.25) * elementary::power(q, 1.0 / 3.0) : 1.0;
}

// "stop" lets a slip end within one step: the larger the step, the more a bed creeps, and rough grains become denser
// by it than smooth ones (doc/theory.md, "Time step").
double chatter(const Contact& contact) {
  constexpr double smooth = 0.2;
  const double friction = std::max(contact.friction, contact.wall_friction);
  const bool stops = contact.tangential == Tangential::sliding && contact.regularisation == Regularisation::stop;
  return stops && friction > smooth ? std::sqrt(std::sqrt(friction / smooth)) : 1.0;
}

// The step [s] at which contacts under a stress [Pa] would begin to chatter. Friction with memory holds a
// particle by springs on all sides: one of eight loaded contacts that spins against its neighbours has omega^2 = 2 x 8
// x 2/3 k_t / (2/5 m); without spin it swings with 16 (k_n + 2 k_t) / 3 m. The scheme is stable for omega dt < 2
// (sqrt(zeta^2 + 1) - zeta). k_t is that of twice the mean overlap.
double holding_step(const Input& in, double radius, double youngs_modulus, double stress) {
  constexpr double contacts = 5.0, loaded = 1.8;  // twice the mean, of forces as uneven as in packs (0.9)
  const Particles& of = in.particles;
  const double modulus = pair_modulus(of, youngs_modulus), nu = of.poisson_ratio;
  if (!(stress > 0.0)) return std::numeric_limits<double>::infinity();
  const double squeezed = 3.0 * std::numbers::sqrt2 * std::numbers::pi * stress / (modulus * contacts);
  const double overlap = loaded * elementary::power(squeezed, 2.0 / 3.0) * radius;
  const double tangential = 8.0 * youngs_modulus / (4.0 * (1.0 + nu) * (2.0 - nu)) * std::sqrt(0.5 * radius * overlap);
  const double normal = tangential * (2.0 - nu) / (2.0 * (1.0 - nu));
  const double m = mass(of, radius);
  const bool spins = in.dynamics.rotation;
  const double omega = std::sqrt((spins ? 80.0 / 3.0 * tangential : 16.0 / 3.0 * (normal + 2.0 * tangential)) / m);
  const double zeta = largest_damping(in) * omega * std::sqrt((spins ? m / 7.0 : m / 2.0) / tangential);
  return 2.0 * (std::sqrt(zeta * zeta + 1.0) - zeta) / omega;
}

}  // namespace

bool components_have_friction(const Input& in) {
  const auto rough = [](const Component& of) { return of.friction > 0.0 || of.wall_friction > 0.0; };
  return std::ranges::any_of(in.components, rough) ||
         std::ranges::any_of(in.pairs, [](const ComponentPair& of) { return of.friction.value_or(0.0) > 0.0; });
}

bool has_friction(const Input& in) {
  return in.contact.friction > 0.0 || in.contact.wall_friction > 0.0 || components_have_friction(in);
}

double largest_damping(const Input& in) {
  if (in.components.empty()) return in.contact.damping_ratio;
  double most = 0.0;
  for (const Component& of : in.components) most = std::max(most, of.damping_ratio);
  for (const ComponentPair& of : in.pairs) most = std::max(most, of.damping_ratio.value_or(0.0));
  return most;
}

double contact_duration(double reduced_mass, double reduced_radius, double reduced_modulus, double speed) {
  const double x = reduced_mass * reduced_mass / (reduced_radius * reduced_modulus * reduced_modulus * speed);
  return 2.87 * (std::isfinite(x) && x > 0.0 ? elementary::fifth_root(x) : x);
}

double fall_time(const Input& in) { return std::sqrt(2.0 * in.layers.thickness / in.jamming.gravity); }

double impact_speed(const Input& in, double drop) {
  const double speed = norm(in.layers.velocity);
  return std::sqrt(2.0 * in.jamming.gravity * drop + speed * speed);
}

double step_limit(const Input& in, double radius, double youngs_modulus, double speed) {
  const double modulus = pair_modulus(in.particles, youngs_modulus);
  const double limit = contact_duration(0.5 * mass(in.particles, radius), 0.5 * radius, modulus, speed) / 5.0;
  // An explicit step dt of an oscillator is stable for omega dt < 2 (sqrt(xi^2 + 1) - xi): eq. (23) holds to xi = 1.
  const double xi = std::max(largest_damping(in), 1.0);
  return limit * ((std::sqrt(xi * xi + 1.0) - xi) / (std::sqrt(2.0) - 1.0));
}

double safe_step(const Input& in, const RadiusRange& radii, double youngs_modulus) {
  return step_limit(in, radii.smallest, youngs_modulus, impact_speed(in, in.layers.thickness)) / squeeze(radii);
}

double automatic_step(const Input& in, const RadiusRange& radii, double youngs_modulus) {
  const double safe = safe_step(in, radii, youngs_modulus);
  if (in.dynamics.theta != 0.0) return safe;
  if (in.contact.tangential != Tangential::mindlin) return safe / chatter(in.contact);
  const double weight = in.particles.density * in.jamming.gravity * in.container.size.back();
  return std::fmin(safe, step_under(in, radii, youngs_modulus, weight));
}

double step_under(const Input& in, const RadiusRange& radii, double youngs_modulus, double stress) {
  return holding_step(in, radii.smallest, youngs_modulus, stress) / press(radii);
}

}  // namespace packmpi::input
