/// Energies and momentum of a moment: a row of the step log.
#include <algorithm>
#include <array>
#include <cmath>

#include "comm/exact_sum.hpp"
#include "dynamics/contact_law.hpp"
#include "geometry/volume.hpp"
#include "observe/kinetic.hpp"
#include "observe/measure.hpp"
#include "observe/touch.hpp"
#include "scene/mixture.hpp"

namespace packmpi::observe {
namespace {

/// Terms of the exact sums, in this order.
enum Term : std::size_t { kinetic, rotational, height, weighted_height, momentum_x, momentum_y, momentum_z, elastic };
constexpr std::size_t term_count = 8;
using Terms = std::array<comm::ExactSum, term_count>;

/// The moving particles; the largest squared speed.
double add_particles(const particles::Store& store, const scene::Scene& scene, Terms& terms) {
  const auto dimension = static_cast<std::size_t>(scene.container.dimension);
  const particles::Layout& layout = store.layout();
  const double equal_mass = scene.in.particles.density * geometry::volume(3, scene.sizes.largest());
  double fastest = 0.0;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const double* record = store.record(i);
    const double mass = scene.features.graded ? scene::mass_of(scene, store, i) : equal_mass;
    for (std::size_t a = 0; a < dimension; ++a) {
      terms[momentum_x + a].add(mass * record[static_cast<std::size_t>(layout.velocity) + a]);
    }
    const Kinetic moving = kinetic_over_mass(store, i);
    terms[kinetic].add(mass * moving.energy());
    if (scene.features.rotation) terms[rotational].add(mass * moving.spin);
    terms[height].add(record[dimension - 1]);
    if (scene.features.graded) terms[weighted_height].add(mass * record[dimension - 1]);
    fastest = std::max(fastest, moving.squared_speed);
  }
  return fastest;
}

/// Elastic energy of a Hertz contact [J]: the integral of stiffness sqrt(r* delta) delta.
double elastic_energy(const dynamics::LawConstants& kind, double reduced_radius, double overlap) {
  return 0.4 * kind.stiffness * std::sqrt(reduced_radius * overlap) * overlap * overlap;
}

/// Of touching pairs.
void add_pairs(const particles::Store& store, const scene::Scene& scene, const dynamics::Law& law,
               const neighbor::Neighborhood& neighborhood, GlobalId frozen_below, comm::ExactSum& energy) {
  const dynamics::StoredView stored = dynamics::stored_pairs(neighborhood);
  const auto add = [&](std::int64_t entry, LocalIndex i, LocalIndex j, double overlap) {
    if (!is_counted_here(store, i, j, frozen_below)) return;
    const double ri = store.radius(i);
    const double rj = store.radius(j);
    energy.add(elastic_energy(law.of_pair(scene::pair_code(store, i, j)), ri * rj / (ri + rj), overlap));
    if (!scene.features.memory) return;
    energy.add(dynamics::pair_spring_energy(scene, law, store, i, j, stored, entry));
  };
  each_touching(store, scene.container, neighborhood.pairs(), add);
}

void add_walls(const particles::Store& store, const scene::Scene& scene, const dynamics::Law& law,
               const neighbor::Neighborhood& neighborhood, comm::ExactSum& energy) {
  const dynamics::StoredView stored = dynamics::stored_walls(neighborhood);
  const auto add = [&](std::int64_t entry, LocalIndex i, neighbor::Wall, const geometry::Facing& at) {
    const double overlap = store.radius(i) - at.distance;
    energy.add(elastic_energy(law.of_wall(scene::wall_code(store, i)), store.radius(i), overlap));
    if (!scene.features.memory) return;
    energy.add(dynamics::wall_spring_energy(scene, law, store, i, at, stored, entry));
  };
  each_touching_wall(store, scene.container, neighborhood.walls(), add);
}

}  // namespace

Ledger ledger(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
              const dynamics::Law& law, const neighbor::Neighborhood& neighborhood, GlobalId frozen_below) {
  Terms terms;
  const double fastest = add_particles(store, scene, terms);
  add_pairs(store, scene, law, neighborhood, frozen_below, terms[elastic]);
  add_walls(store, scene, law, neighborhood, terms[elastic]);
  const std::vector<double> sums = comm::exact_sums(comm, terms);
  const auto particles = static_cast<double>(comm.sum(std::int64_t{store.owned()}));
  const double equal_mass = scene.in.particles.density * geometry::volume(3, scene.sizes.largest());
  const double weighted = scene.features.graded ? sums[weighted_height] : equal_mass * sums[height];
  return {.kinetic_energy = sums[kinetic],
          .rotational_energy = sums[rotational],
          .potential_energy = scene.in.jamming.gravity * weighted,
          .elastic_energy = sums[elastic],
          .momentum = {sums[momentum_x], sums[momentum_y], sums[momentum_z]},
          .max_speed = std::sqrt(comm.max(fastest)),
          .mean_height = particles > 0.0 ? sums[height] / particles : 0.0};
}

double energy_of(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene, GlobalId from,
                 GlobalId to) {
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  comm::ExactSum energy;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const GlobalId id = store.ids()[static_cast<std::size_t>(i)];
    if (id < from || id >= to) continue;
    const double mass = scene::mass_of(scene, store, i);
    energy.add(mass * (kinetic_over_mass(store, i).energy() + scene.in.jamming.gravity * store.position(i)[vertical]));
  }
  return comm::exact_sum(comm, energy);
}

}  // namespace packmpi::observe
