#include <algorithm>
#include <array>
#include <cmath>

#include "observe/measure.hpp"

namespace packmpi::observe {
namespace {

bool is_finite(const particles::Store& store, LocalIndex i) {
  const auto all_finite = [](const Vec3& v) {
    return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
  };
  return all_finite(store.position(i)) && all_finite(store.velocity(i)) && all_finite(store.spin(i)) &&
         std::isfinite(store.radius(i));
}

}  // namespace

Validity validity(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene) {
  std::array<std::int64_t, 3> counts{store.owned(), 0, 0};
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    if (!is_finite(store, i)) ++counts[1];
    if (scene.container.beyond(store.position(i)) > 0.0) ++counts[2];
  }
  comm.sum(counts);
  return {.found = counts[0], .non_finite = counts[1], .outside = counts[2]};
}

}  // namespace packmpi::observe
