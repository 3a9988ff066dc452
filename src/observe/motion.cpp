#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/volume.hpp"
#include "observe/measure.hpp"

namespace packmpi::observe {
namespace {

/// (r omega)^2 [m2/s2], from the record, which holds r omega.
double squared_spin(const particles::Store& store, LocalIndex i) {
  const particles::Layout& layout = store.layout();
  double sum = 0.0;
  for (int c = 0; c < layout.spin_components(); ++c) {
    const double s = store.record(i)[layout.spin + c];
    sum += s * s;
  }
  return sum;
}

}  // namespace

Motion motion(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene) {
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  const auto count = static_cast<std::size_t>(store.owned());
  std::array<std::vector<double>, 3> terms{std::vector<double>(count), std::vector<double>(count),
                                           std::vector<double>(count)};  // kinetic energy, height, mass
  double fastest = 0.0;                                                  // squared
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const Vec3 v = store.velocity(i);
    const double squared = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    const double mass = scene.in.particles.density * geometry::volume(3, store.radius(i));  // discs are spheres too
    const auto k = static_cast<std::size_t>(i);
    terms[0][k] = mass * (0.5 * squared + 0.2 * squared_spin(store, i));  // j = 2/5 m r^2
    terms[1][k] = store.position(i)[vertical];
    terms[2][k] = mass;
    fastest = std::max(fastest, squared);
  }
  const std::vector<double> sums = comm::exact_sums(comm, terms);
  const std::int64_t particles = comm.sum(std::int64_t{store.owned()});
  return {.kinetic_energy = sums[0],
          .max_speed = std::sqrt(comm.max(fastest)),
          .mean_height = particles > 0 ? sums[1] / static_cast<double>(particles) : 0.0,
          .mass = sums[2]};
}

}  // namespace packmpi::observe
