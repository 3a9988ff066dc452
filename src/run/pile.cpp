#include "run/pile.hpp"

#include <algorithm>

namespace packmpi::run {

Pile::Pile(const comm::Comm& world, const scene::Scene& what)
    : comm(world),
      scene(what),
      ownership(world, geometry::ColumnGrid(what.box, what.column_width()), what.in.parallel.decomposition),
      store(what.features.layout()),
      neighborhood(world, what, ownership),
      stepper(world, what) {}

std::vector<std::int32_t> Pile::layers() const {
  std::vector<std::int32_t> layer;
  layer.reserve(static_cast<std::size_t>(store.owned()));
  for (const GlobalId id : store.ids().first(static_cast<std::size_t>(store.owned()))) {
    layer.push_back(static_cast<std::int32_t>(std::ranges::upper_bound(first_ids, id) - first_ids.begin()) - 1);
  }
  return layer;
}

double Pile::bytes_per_particle() const {
  const auto bytes = static_cast<double>(store.bytes() + neighborhood.bytes() + stepper.bytes());
  return comm.max(bytes / static_cast<double>(std::max<LocalIndex>(1, store.owned())));
}

}  // namespace packmpi::run
