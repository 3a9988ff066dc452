#include <algorithm>
#include <array>
#include <cmath>

#include "comm/exact_sum.hpp"
#include "observe/kinetic.hpp"
#include "observe/measure.hpp"
#include "scene/mixture.hpp"

namespace packmpi::observe {
Motion motion(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene) {
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  std::array<comm::ExactSum, 3> terms;  // kinetic energy, height, mass
  double fastest = 0.0;                 // squared
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const Kinetic moving = kinetic_over_mass(store, i);
    const double mass = scene::mass_of(scene, store, i);
    terms[0].add(mass * moving.energy());
    terms[1].add(store.position(i)[vertical]);
    terms[2].add(mass);
    fastest = std::max(fastest, moving.squared_speed);
  }
  const std::vector<double> sums = comm::exact_sums(comm, terms);
  const std::int64_t particles = comm.sum(std::int64_t{store.owned()});
  return {.kinetic_energy = sums[0],
          .max_speed = std::sqrt(comm.max(fastest)),
          .mean_height = particles > 0 ? sums[1] / static_cast<double>(particles) : 0.0,
          .mass = sums[2]};
}

}  // namespace packmpi::observe
