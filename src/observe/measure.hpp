/// Measures of a pack: read only, the same on any number of ranks.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "comm/comm.hpp"
#include "dynamics/contact_law.hpp"
#include "neighbor/neighborhood.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::observe {

/// Top of the highest particle [m]; 0 if there is none. Collective.
[[nodiscard]] double top(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene);

/// Mean over lateral columns about one largest diameter wide (floor(L / (2 r_max)) per axis, at least 1) of the highest
/// particle top in the column (by centre; an empty column counts 0) [m]; in a round vessel each column counts by the
/// share of it that centres can be in. Collective; a PETSc DMDA vector holds the
/// columns, or of more than `most_stored` (128 MiB) those that are not empty go by mail: the same bits.
[[nodiscard]] double surface_height(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                                    std::int64_t most_stored = std::int64_t{1} << 24);
/// The same over the owned particles of several stores together.
[[nodiscard]] double surface_height(const comm::Comm& comm, std::span<const particles::Store* const> stores,
                                    const scene::Scene& scene, std::int64_t most_stored = std::int64_t{1} << 24);

/// The bulk of a bed: heights [m] between 0.2 and 0.8 of H_d; of a bed that does not reach 0.8 H_d, of its own surface;
/// under a lid, of the lid's height.
struct Bulk {
  double low = 0.0, high = 0.0;
  [[nodiscard]] bool has(double height) const noexcept { return height >= low && height < high; }
  [[nodiscard]] double depth() const noexcept { return high - low; }
};
/// [m] H_d, or a lid below it: solid fractions and maps are of what is below. Local.
[[nodiscard]] double upper_end(const geometry::Container& container);

/// Of a bed with this surface_height() [m]. Local.
[[nodiscard]] Bulk bulk_of(const scene::Scene& scene, double surface);

/// Solid fractions (CC16 eq. 22).
struct Density {
  double phi;       ///< below H_d, or the lid if that is lower
  double phi_bulk;  ///< of the bulk; 0 if that is empty
};
[[nodiscard]] Density density(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                              const Bulk& bulk);  ///< collective

/// Energy and motion of all particles. Collective.
struct Motion {
  double kinetic_energy;  ///< [J] translation and spin
  double max_speed;       ///< [m/s]
  double mean_height;     ///< [m] of the centres
  double mass;            ///< [kg]
};
[[nodiscard]] Motion motion(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene);

/// Energies and momentum of the moving particles at this instant, for the step log.
struct Ledger {
  double kinetic_energy;     ///< [J] translation and spin; as Motion's, to the bit
  double rotational_energy;  ///< [J] of it, spin
  double potential_energy;   ///< [J] of gravity; 0 with all centres on the floor
  double elastic_energy;     ///< [J] of the contacts of moving particles, with each other, the frozen and walls, and of
                             ///< their tangential, rolling and twisting springs
  Vec3 momentum;             ///< [kg m/s]
  double max_speed;          ///< [m/s]
  double mean_height;        ///< [m] of the centres
};
/// Collective; from current lists and ghosts. Exact sums. `frozen_below`: ids below it are frozen. Cost: about two
/// steps.
[[nodiscard]] Ledger ledger(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                            const dynamics::Law& law, const neighbor::Neighborhood& neighborhood,
                            GlobalId frozen_below = 0);
/// The unbalanced force ratio of the moving particles: mean magnitude of the force on one (contacts with particles and
/// walls, weight, drag, near field) over the mean magnitude of a contact force; 0 at rest, infinite where nothing
/// touches. That of the instant: friction that stops its slip within a step is in it. NaN if a near-field force is out
/// of range. Collective; from current lists and ghosts. Exact sums. Cost: about two steps.
[[nodiscard]] double unbalanced_force(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                                      const dynamics::Law& law, const neighbor::Neighborhood& neighborhood,
                                      GlobalId frozen_below = 0);
/// Kinetic and potential energy [J] of the owned particles with ids in [from, to). Collective, exact.
[[nodiscard]] double energy_of(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                               GlobalId from, GlobalId to);

/// Contacts at this instant, from current lists and ghosts: of all particles, or of the moving ones with each other and
/// with the frozen, whose ids are below `frozen_below`. Collective.
struct Contacts {
  std::vector<std::int32_t> of_particle;  ///< touching particles of each owned slot (walls not counted)
  std::int64_t pairs = 0;                 ///< touching pairs, over all ranks
  std::int64_t pairs_here = 0;            ///< of them, counted by this rank; each pair by one
  double coordination = 0.0;              ///< mean of of_particle over all ranks
  double mean_overlap = 0.0;              ///< over touching pairs, overlap / smaller radius
  double max_overlap = 0.0;
  double max_wall_penetration = 0.0;  ///< penetration / radius
};
[[nodiscard]] Contacts contacts(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                                const neighbor::PairList& pairs, const neighbor::WallList& walls,
                                GlobalId frozen_below = 0);

/// Radii got. Collective.
struct SizeStatistics {
  double mean, sd, min, max;  ///< [m], by number
};
[[nodiscard]] SizeStatistics sizes(const comm::Comm& comm, const particles::Store& store);

/// Particles that are where no particle may be. Collective.
struct Validity {
  std::int64_t found = 0;  ///< owned over all ranks
  std::int64_t non_finite = 0;
  std::int64_t outside = 0;  ///< centre beyond a wall or the floor
};
[[nodiscard]] Validity validity(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene);

/// The force of one contact, for /contacts and /wall_contacts of the pack file.
struct ContactForce {
  GlobalId first, second;                   ///< first < second; of a wall: the particle, and neighbor::wall_partner
  double overlap;                           ///< [m]
  Vec3 force;                               ///< [N] on the first: normal and friction, without near field
  Vec3 branch{};                            ///< [m] from the centre of the first to that of the second; not of walls
  Vec3 middle{};                            ///< [m] the point half-way, inside periodic axes; not of walls
  Vec3 normal{};                            ///< unit vector from the first to the second
  dynamics::SpringDisplacements springs{};  ///< zero without memory
};
/// Calls take(contact) for each touching pair whose smaller id is owned here, in the order of the list. Local; cost
/// O(pairs). `stored`: what the pairs remember; without it friction with memory is its dashpot's alone.
void each_contact(const particles::Store& store, const scene::Scene& scene, const neighbor::PairList& pairs,
                  const dynamics::StoredView& stored, const std::function<void(const ContactForce&)>& take);
/// The touching pairs whose smaller id is owned here, sorted by (first, second). Local; cost O(pairs log pairs).
/// Every pair of the scene is returned by exactly one rank, with the same bits on any number of them.
[[nodiscard]] std::vector<ContactForce> contact_forces(const particles::Store& store, const scene::Scene& scene,
                                                       const neighbor::PairList& pairs,
                                                       const dynamics::StoredView& stored = {});

/// The same of the walls that owned particles touch, sorted by particle and wall; `stored` is what walls remember.
[[nodiscard]] std::vector<ContactForce> wall_forces(const particles::Store& store, const scene::Scene& scene,
                                                    const neighbor::WallList& walls,
                                                    const dynamics::StoredView& stored = {});

/// Normal force between the floor and the particles on it [N]; equals their weight at rest. Collective.
[[nodiscard]] double floor_force(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                                 const neighbor::WallList& walls);

}  // namespace packmpi::observe
