/// Is a pack at rest? The measures that say so, and who holds it up; the same bits on any number of ranks.
#pragma once
#include "comm/comm.hpp"
#include "neighbor/neighborhood.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::observe {

/// The contact network. A particle is held by dimension + 1 forces at least: its contacts with particles and walls, and
/// its weight if there is gravity. One with fewer is a rattler; without it others may be held no longer, and so on
/// until none is left that is not held.
struct Network {
  double coordination = 0.0;       ///< Z: contacts with particles, over all particles
  double loose = 0.0;              ///< share with too few contacts, before any is taken away
  double rattlers = 0.0;           ///< share that is not held, recursively
  double held_coordination = 0.0;  ///< Z without rattlers: contacts between held particles, over those
};
/// Collective; from current lists and ghosts, everything moving. Cost: a pass over the pairs a round of removal; rounds
/// are few but where a bed comes apart from its surface down.
[[nodiscard]] Network network(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                              const neighbor::Neighborhood& neighborhood);

/// How near to rest. Without gravity, kinetic_energy and support are 0.
struct Rest {
  double unbalanced_force = 0.0;  ///< mean net force on a particle over the mean contact force: observe::balance()
  double kinetic_energy = 0.0;    ///< mean of a particle, spin included, over m g d of a particle of mean mass and size
  /// Vertical force of floor and walls on the particles, friction included, over the weight that they must bear: less
  /// what a fluid lifts of particles at rest; and with a lid over what it presses with, too. 1 at rest; 0 if the fluid
  /// lifts it all.
  double support = 0.0;
  double mean_overlap = 0.0;   ///< of touching particles, over the smaller radius
  double worst_overlap = 0.0;  ///< of two particles, or with a wall, over the smaller radius
  Network network;
};
/// Collective; from current lists and ghosts, everything moving, by the law of the scene's last stage. Exact sums.
/// Cost: about five steps, and network().
[[nodiscard]] Rest rest(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                        const neighbor::Neighborhood& neighborhood);

}  // namespace packmpi::observe
