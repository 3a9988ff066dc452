/// Bounds that follow from a scene: how fast its particles can be, how hard they can meet, how many layers it takes.
#pragma once
#include <cstdint>
#include <numbers>

#include "scene/scene.hpp"

namespace packmpi::scene {

[[nodiscard]] inline double mass(const input::Particles& particles, double radius) {  ///< [kg]
  return particles.density * 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
}

/// E* of a pair of particles of this modulus [Pa].
[[nodiscard]] inline double pair_modulus(const input::Particles& particles, double youngs_modulus) {
  return youngs_modulus / (2.0 * (1.0 - particles.poisson_ratio * particles.poisson_ratio));
}

/// Speed [m/s] of a particle that has fallen `drop` [m] from where it was inserted; eq. (23) wants one.
[[nodiscard]] double impact_speed(const input::Input& in, double drop);

/// Limit of the time step for particles of this radius and modulus that meet at `speed` [s]: duration / 5 of eq. (23),
/// less where the damping is beyond critical (doc/theory.md). Infinite at speed 0.
[[nodiscard]] double step_limit(const input::Input& in, double radius, double youngs_modulus, double speed);

/// Every layer adds phi_0 h_0 of solid and no pile is denser than solid: more layers than this never come to H_d.
[[nodiscard]] std::int64_t most_layers(const input::Input& in);

/// What no particle of a sound run comes near [m/s]: 16 times what falls, inserted speeds, fluid and near field can
/// give together (doc/theory.md, "Guards").
[[nodiscard]] double speed_bound(const Scene& scene);

/// The unit in which forces are summed [N], a power of two. Throws Error(bad_input) where the largest force and the
/// weight of the smallest particle are too far apart for one unit.
[[nodiscard]] double force_quantum(const Scene& scene);

}  // namespace packmpi::scene
