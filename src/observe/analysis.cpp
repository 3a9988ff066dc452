#include "observe/analysis.hpp"

#include "observe/measure.hpp"

namespace packmpi::observe {

Specimen specimen_of(const comm::Comm& comm, const scene::Scene& scene, const particles::Store& store,
                     const neighbor::Neighborhood& neighborhood, double range) {
  const double surface = surface_height(comm, store, scene);
  return {comm, scene, store, neighborhood, range, surface, bulk_of(scene, surface)};
}

Analysis analyse(const Specimen& pack) {
  Analysis a;
  a.particles = pack.comm.sum(std::int64_t{pack.store.owned()});
  a.mean_diameter = 2.0 * pack.scene.sizes.mean();
  a.sizes = size_match(pack.comm, pack.store, pack.scene.sizes.curve());
  for (int axis = 0; axis < pack.scene.container.dimension; ++axis) a.density.push_back(density_profile(pack, axis));
  a.radial = radial_profile(pack);
  a.segregation = segregation(pack);
  a.pairs = pair_distribution(pack);
  a.springs = pack.springs;
  a.rest = rest(pack.comm, pack.store, pack.scene, pack.neighborhood);
  a.forces = forces(pack);
  a.floor_force = floor_force(pack.comm, pack.store, pack.scene, pack.neighborhood.walls());
  a.composition = composition(pack.comm, pack.store, pack.scene, pack.bulk, {});
  a.weight = motion(pack.comm, pack.store, pack.scene).mass * pack.scene.in.jamming.gravity;
  a.order = order(pack);
  a.local = local_density(pack);
  return a;
}

}  // namespace packmpi::observe
