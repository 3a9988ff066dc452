#include <algorithm>

#include "observe/measure.hpp"

namespace packmpi::observe {

double top(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene) {
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  double mine = 0.0;
  for (LocalIndex i = 0; i < store.owned(); ++i) mine = std::max(mine, store.position(i)[vertical] + store.radius(i));
  return comm.max(mine);
}

}  // namespace packmpi::observe
