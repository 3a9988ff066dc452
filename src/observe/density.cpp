#include <algorithm>
#include <array>
#include <cmath>

#include "comm/exact_sum.hpp"
#include "geometry/volume.hpp"
#include "observe/measure.hpp"

namespace packmpi::observe {

double upper_end(const geometry::Container& container) {
  return std::min(container.height(), container.lid.value_or(HUGE_VAL));
}

Bulk bulk_of(const scene::Scene& scene, double surface) {
  constexpr double low = 0.2, high = 0.8;
  const double wanted = scene.container.height();
  if (scene.container.lid) return {low * *scene.container.lid, high * *scene.container.lid};
  const double height = surface < high * wanted ? surface : wanted;
  return {low * height, high * height};
}

Density density(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene, const Bulk& bulk) {
  const int dimension = scene.container.dimension;
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  const double height = upper_end(scene.container);

  std::array<comm::ExactSum, 3> solid;  // below H_d, low, high
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const double centre = store.position(i)[vertical];
    const double r = store.radius(i);
    solid[0].add(geometry::volume_below(dimension, r, centre, height));
    solid[1].add(geometry::volume_below(dimension, r, centre, bulk.low));
    solid[2].add(geometry::volume_below(dimension, r, centre, bulk.high));
  }
  const std::vector<double> sums = comm::exact_sums(comm, solid);
  const double volume = scene.container.volume_between(bulk.low, bulk.high);
  return {.phi = sums[0] / scene.container.volume_between(0.0, height),
          .phi_bulk = volume > 0.0 ? (sums[2] - sums[1]) / volume : 0.0};
}

}  // namespace packmpi::observe
