/// Energies and momentum of a moment: a row of the step log.
#include <algorithm>
#include <array>
#include <cmath>

#include "dynamics/contact_law.hpp"
#include "geometry/volume.hpp"
#include "observe/measure.hpp"
#include "observe/touch.hpp"

namespace packmpi::observe {
namespace {

/// Terms of the exact sums, in this order.
enum Term : std::size_t { kinetic, rotational, height, weighted_height, momentum_x, momentum_y, momentum_z, elastic };
constexpr std::size_t term_count = 8;
using Terms = std::array<std::vector<double>, term_count>;

/// (r omega)^2 [m2/s2], from the record, which holds r omega.
double squared_spin(const particles::Store& store, const double* record) {
  const particles::Layout& layout = store.layout();
  double sum = 0.0;
  for (int c = 0; c < layout.spin_components(); ++c) sum += record[layout.spin + c] * record[layout.spin + c];
  return sum;
}

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
    const double mass = scene.features.graded
                            ? scene.in.particles.density * geometry::volume(3, record[layout.radius])  // discs too
                            : equal_mass;
    double squared = 0.0;
    for (std::size_t a = 0; a < dimension; ++a) {
      const double v = record[static_cast<std::size_t>(layout.velocity) + a];
      squared += v * v;
      terms[momentum_x + a][i] = mass * v;
    }
    const double spin = squared_spin(store, record);
    terms[kinetic][i] = mass * (0.5 * squared + 0.2 * spin);  // j = 2/5 m r^2
    if (scene.features.rotation) terms[rotational][i] = mass * (0.2 * spin);
    terms[height][i] = record[dimension - 1];
    if (scene.features.graded) terms[weighted_height][i] = mass * record[dimension - 1];
    fastest = std::max(fastest, squared);
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
  const neighbor::PairList& pairs = neighborhood.pairs();
  const dynamics::StoredView stored = dynamics::stored_pairs(neighborhood);
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    const LocalIndex i = pairs.first[p];
    const LocalIndex j = pairs.second[p];
    const double overlap = touch(store, scene.container, i, j).overlap;
    if (!(overlap > 0.0)) continue;
    if (!is_counted_here(store, i, j, frozen_below)) continue;
    const double ri = store.radius(i);
    const double rj = store.radius(j);
    terms.push_back(elastic_energy(law.pair, ri * rj / (ri + rj), overlap));
    if (!scene.features.memory) continue;
    terms.push_back(
        dynamics::pair_contact(scene, law, store, i, j, stored, static_cast<std::int64_t>(p)).spring_energy);
  }
}

void add_walls(const particles::Store& store, const scene::Scene& scene, const dynamics::Law& law,
               const neighbor::Neighborhood& neighborhood, std::vector<double>& terms) {
  const neighbor::WallList& walls = neighborhood.walls();
  const dynamics::StoredView stored = dynamics::stored_walls(neighborhood);
  for (std::size_t w = 0; w < walls.particle.size(); ++w) {
    const LocalIndex i = walls.particle[w];
    const double overlap = wall_penetration(store, scene.container, i, walls.wall[w]);
    if (!(overlap > 0.0)) continue;
    terms.push_back(elastic_energy(law.wall, store.radius(i), overlap));
    if (!scene.features.memory) continue;
    const auto entry = static_cast<std::int64_t>(w);
    terms.push_back(dynamics::wall_contact(scene, law, store, i, walls.wall[w], stored, entry).spring_energy);
  }
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
    const Vec3 v = store.velocity(i);
    const double squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    const double mass = scene.in.particles.density * geometry::volume(3, store.radius(i));
    terms.push_back(mass * (0.5 * squared + 0.2 * squared_spin(store, store.record(i)) +
                            scene.in.jamming.gravity * store.position(i)[vertical]));
  }
  return comm::exact_sum(comm, terms);
}

}  // namespace packmpi::observe
