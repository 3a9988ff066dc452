#include "observe/rest.hpp"

#include <algorithm>
#include <array>

#include "comm/exact_sum.hpp"
#include "dynamics/contact_law.hpp"
#include "observe/measure.hpp"
#include "observe/touch.hpp"

namespace packmpi::observe {
namespace {

/// Vertical force on the particles [N]: upward of floor and walls, downward of the lid.
struct Borne {
  double by_walls, by_lid;
};
Borne vertical_forces(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                      const dynamics::Law& law, const neighbor::Neighborhood& neighborhood) {
  const dynamics::StoredView stored = dynamics::stored_walls(neighborhood);
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  std::array<comm::ExactSum, 2> forces;
  const auto add = [&](std::int64_t entry, LocalIndex i, neighbor::Wall wall, const geometry::Facing& at) {
    forces.at(wall == neighbor::Wall::lid ? 1 : 0)
        .add(dynamics::wall_contact(scene, law, store, i, at, stored, entry).force[vertical]);
  };
  each_touching_wall(store, scene.container, neighborhood.walls(), add);
  const std::vector<double> sums = comm::exact_sums(comm, forces);
  return {sums[0], -sums[1]};
}

/// What floor and walls must bear of particles at rest [N].
double load(const scene::Scene& scene, const Motion& motion, double particles) {
  const input::Drag& drag = scene.in.drag;
  const double lift = drag.coefficient * drag.fluid_velocity[static_cast<std::size_t>(scene.container.vertical())];
  return motion.mass * scene.in.jamming.gravity - particles * lift;
}

}  // namespace

Rest rest(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
          const neighbor::Neighborhood& neighborhood) {
  const dynamics::Law law = dynamics::make_law(scene);
  const Contacts touching = contacts(comm, store, scene, neighborhood.pairs(), neighborhood.walls());
  const Motion moving = motion(comm, store, scene);
  Rest result{.unbalanced_force = unbalanced_force(comm, store, scene, law, neighborhood),
              .mean_overlap = touching.mean_overlap,
              .worst_overlap = std::max(touching.max_overlap, touching.max_wall_penetration),
              .network = network(comm, store, scene, neighborhood)};
  const double mgd = moving.mass * scene.in.jamming.gravity * 2.0 * scene.sizes.mean();  // of all particles together
  if (!(mgd > 0.0)) return result;
  result.kinetic_energy = moving.kinetic_energy / mgd;
  const auto particles = static_cast<double>(comm.sum(std::int64_t{store.owned()}));
  const double borne = load(scene, moving, particles);
  const Borne forces = vertical_forces(comm, store, scene, law, neighborhood);
  if (borne > 0.0) result.support = forces.by_walls / (borne + forces.by_lid);
  return result;
}

}  // namespace packmpi::observe
