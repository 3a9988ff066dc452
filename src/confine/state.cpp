#include "confine/state.hpp"

namespace packmpi::confine {

void apply(const State& state, geometry::Container& box) {
  if (!state.on) return;
  const auto vertical = static_cast<std::size_t>(box.vertical());
  box.lid = state.lid;
  box.speed[vertical] = state.lid_speed;
  for (std::size_t axis = 0; axis < vertical; ++axis) {
    box.size[axis] = state.size[axis];
    if (!box.periodic[axis]) box.speed[axis] = state.speed[axis];
  }
}

}  // namespace packmpi::confine
