/// The time step that a scene allows: eq. (23) of the paper and what "auto" makes of it (doc/theory.md, "Time step").
#pragma once
#include <numbers>

#include "config/input.hpp"
#include "config/radius_range.hpp"

namespace packmpi::input {

[[nodiscard]] inline double mass(const Particles& particles, double radius) {  ///< [kg]
  return particles.density * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

/// Has any contact friction: by [contact], or of a component or a pair of them?
[[nodiscard]] bool has_friction(const Input& in);
/// Has any component, or pair of them, friction of its own?
[[nodiscard]] bool components_have_friction(const Input& in);
/// The largest ratio of damping of any contact.
[[nodiscard]] double largest_damping(const Input& in);

/// E* of a pair of particles of this modulus [Pa].
[[nodiscard]] inline double pair_modulus(const Particles& particles, double youngs_modulus) {
  return youngs_modulus / (2.0 * (1.0 - particles.poisson_ratio * particles.poisson_ratio));
}

/// Duration of an elastic impact [s], eq. (23), from m* [kg], r* [m], E* [Pa] and the speed [m/s]. Infinite at speed 0.
/// The same bits on any machine.
[[nodiscard]] double contact_duration(double reduced_mass, double reduced_radius, double reduced_modulus, double speed);

/// [s] of a free fall through a layer's region: what presets measure times by. Precondition: there is gravity.
[[nodiscard]] double fall_time(const Input& in);

/// Speed [m/s] of a particle that has fallen `drop` [m] from where it was inserted; eq. (23) wants one.
[[nodiscard]] double impact_speed(const Input& in, double drop);

/// Limit of the time step for particles of this radius and modulus that meet at `speed` [s]: duration / 5 of eq. (23),
/// less where the damping is beyond critical (doc/theory.md). Infinite at speed 0.
[[nodiscard]] double step_limit(const Input& in, double radius, double youngs_modulus, double speed);

/// The limit for the smallest particles that fall through a layer's region, heeding large particles that land on small
/// ones: the step beyond which `packmpi` warns [s].
[[nodiscard]] double safe_step(const Input& in, const RadiusRange& radii, double youngs_modulus);

/// The step of time_step = "auto" [s]: safe_step(), less for rough particles without memory; with it, no more than what
/// contacts under the weight of the bed bear (doc/theory.md, "Time step").
[[nodiscard]] double automatic_step(const Input& in, const RadiusRange& radii, double youngs_modulus);

/// The step [s] beyond which contacts under a stress [Pa] begin to chatter: with friction that remembers a particle is
/// held by springs on all sides.
[[nodiscard]] double step_under(const Input& in, const RadiusRange& radii, double youngs_modulus, double stress);

}  // namespace packmpi::input
