/// Energies and momentum of a moment: a row of the step log.
#include <algorithm>
#include <array>
#include <cmath>

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
using Terms = std::array<std::vector<double>, term_count>;

/// Terms of the moving particles; the largest squared speed.
double add_particles(const particles::Store& store, const scene::Scene& scene, Terms& terms) {
  const auto count = static_cast<std::size_t>(store.owned());
  const auto dimension = static_cast<std::size_t>(scene.container.dimension);
  for (std::size_t t = kinetic; t < momentum_x + dimension; ++t) terms[t].resize(count);
  if (!scene.features.rotation) terms[rotational].clear();
  if (!scene.features.graded) terms[weighted_height].clear();
  const particles::Layout& layout = store.layout();
  const double equal_mass = scene.in.particles.density * geometry::volume(3, scene.sizes.largest());
  double fastest = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const double* record = store.record(static_cast<LocalIndex>(i));
    const double mass = scene.features.graded ? scene::mass_of(scene, store, static_cast<LocalIndex>(i)) : equal_mass;
    for (std::size_t a = 0; a < dimension; ++a) {
      terms[momentum_x + a][i] = mass * record[static_cast<std::size_t>(layout.velocity) + a];
    }
    const Kinetic moving = kinetic_over_mass(store, static_cast<LocalIndex>(i));
    terms[kinetic][i] = mass * moving.energy();
    if (scene.features.rotation) terms[rotational][i] = mass * moving.spin;
    terms[height][i] = record[dimension - 1];
    if (scene.features.graded) terms[weighted_height][i] = mass * record[dimension - 1];
    fastest = std::max(fastest, moving.squared_speed);
  }
  return fastest;
}

/// Elastic energy of a Hertz contact [J]: the integral of stiffness sqrt(r* delta) delta.
double elastic_energy(const dynamics::LawConstants& kind, double reduced_radius, double overlap) {
  return 0.4 * kind.stiffness * std::sqrt(reduced_radius * overlap) * overlap * overlap;
}

/// One term for each touching pair.
void add_pairs(const particles::Store& store, const scene::Scene& scene, const dynamics::Law& law,
               const neighbor::Neighborhood& neighborhood, GlobalId frozen_below, std::vector<double>& terms) {
  const dynamics::StoredView stored = dynamics::stored_pairs(neighborhood);
  const auto add = [&](std::int64_t entry, LocalIndex i, LocalIndex j, double overlap) {
    if (!is_counted_here(store, i, j, frozen_below)) return;
    const double ri = store.radius(i);
    const double rj = store.radius(j);
    terms.push_back(elastic_energy(law.of_pair(scene::pair_code(store, i, j)), ri * rj / (ri + rj), overlap));
    if (!scene.features.memory) return;
    terms.push_back(dynamics::pair_spring_energy(scene, law, store, i, j, stored, entry));
  };
  each_touching(store, scene.container, neighborhood.pairs(), add);
}

void add_walls(const particles::Store& store, const scene::Scene& scene, const dynamics::Law& law,
               const neighbor::Neighborhood& neighborhood, std::vector<double>& terms) {
  const dynamics::StoredView stored = dynamics::stored_walls(neighborhood);
  const auto add = [&](std::int64_t entry, LocalIndex i, neighbor::Wall, const geometry::Facing& at) {
    const double overlap = store.radius(i) - at.distance;
    terms.push_back(elastic_energy(law.of_wall(scene::wall_code(store, i)), store.radius(i), overlap));
    if (!scene.features.memory) return;
    terms.push_back(dynamics::wall_spring_energy(scene, law, store, i, at, stored, entry));
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
  std::vector<double> terms;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const GlobalId id = store.ids()[static_cast<std::size_t>(i)];
    if (id < from || id >= to) continue;
    const double mass = scene::mass_of(scene, store, i);
    terms.push_back(mass *
                    (kinetic_over_mass(store, i).energy() + scene.in.jamming.gravity * store.position(i)[vertical]));
  }
  return comm::exact_sum(comm, terms);
}

}  // namespace packmpi::observe
