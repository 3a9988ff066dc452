/// The servo of the lid and of moving sides: which speed the stress on them gives (doc/howto_confinement.md has the
/// formulas).
#pragma once
#include <cstdint>

#include "confine/state.hpp"
#include "scene/scene.hpp"

namespace packmpi::confine {

/// What the program chooses of a servo. A side is a plate of a mass that the stress asked for pushes inward, and that
/// is held back by a dashpot of the bed's own impedance, which swallows waves that come to it:
///   mass v' = sigma - target - impedance v,   v outward positive, |v| <= closing.
struct Gains {
  double modulus = 0.0;    ///< [Pa] of the bed for one-dimensional compression, under the stress asked for
  double density = 0.0;    ///< [kg/m3] of the bed
  double impedance = 0.0;  ///< [Pa s/m] sqrt(density modulus)
  double closing = 0.0;    ///< [m/s] fastest
  double crossing = 0.0;   ///< [s] that waves take through the specimen, the longest way that they are sent
};
/// Of a bed of that height [m] and mass [kg] in the container of the scene as it was asked for: the same however far
/// lid and sides have moved. Local, pure; same bits on any machine.
[[nodiscard]] Gains gains_of(const scene::Scene& scene, double height, double mass);

/// Steps between looks at the stress on the lid, and at that of the contacts, which is dearer. Local.
[[nodiscard]] std::int64_t lid_tick(const scene::Scene& scene, const Gains& gains);
[[nodiscard]] std::int64_t side_tick(const scene::Scene& scene, const Gains& gains);

/// Steps that a bed of that height [m] and mass [kg] takes, about: the lid comes down and presses at its closing speed,
/// and waves die away. 0 without [confinement]. Local.
[[nodiscard]] std::int64_t expected_steps(const scene::Scene& scene, double height, double mass);

/// Areal mass [kg/m2] of the plate: of the lid that of a layer of particles under it; of a periodic axis a quarter of
/// the bed's, so that box and bed swing together, critically damped.
[[nodiscard]] double lid_mass(const scene::Scene& scene, const Gains& gains);
[[nodiscard]] double side_mass(const scene::Scene& scene, const Gains& gains, std::size_t axis);

/// The speed [m/s] after `seconds` of a stress that differs from the target by `excess` [Pa], outward positive.
[[nodiscard]] double next_speed(const Gains& gains, double areal_mass, double speed, double excess, double seconds);

}  // namespace packmpi::confine
