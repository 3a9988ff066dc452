#include <array>

#include "geometry/volume.hpp"
#include "observe/measure.hpp"

namespace packmpi::observe {

Density density(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene) {
  const int dimension = scene.box.dimension;
  const auto vertical = static_cast<std::size_t>(scene.box.vertical());
  const double height = scene.box.height();
  const double low = 0.2 * height;
  const double high = 0.8 * height;

  const auto count = static_cast<std::size_t>(store.owned());
  std::array<std::vector<double>, 3> solid{std::vector<double>(count), std::vector<double>(count),
                                           std::vector<double>(count)};  // below H_d, low, high
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const double centre = store.position(i)[vertical];
    const double r = store.radius(i);
    const auto k = static_cast<std::size_t>(i);
    solid[0][k] = geometry::volume_below(dimension, r, centre, height);
    solid[1][k] = geometry::volume_below(dimension, r, centre, low);
    solid[2][k] = geometry::volume_below(dimension, r, centre, high);
  }
  const std::vector<double> sums = comm::exact_sums(comm, solid);
  const double area = scene.box.floor_area();
  return {.phi = sums[0] / (area * height), .phi_bulk = (sums[2] - sums[1]) / (area * (high - low))};
}

}  // namespace packmpi::observe
