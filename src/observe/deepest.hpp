/// Where particles overlap most.
#pragma once
#include "comm/comm.hpp"
#include "neighbor/lists.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::observe {

struct Deepest {
  double overlap = 0.0;  ///< over the smaller radius, or of a particle in a wall over its own; 0: nothing touches
  GlobalId first = -1, second = -1;  ///< ids, first < second; second is -1 in a wall. Of equal overlaps the first
  Vec3 at{};                         ///< [m] centre of the first
};

/// From current lists and ghosts. Collective; the same on any ranks.
[[nodiscard]] Deepest deepest(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                              const neighbor::PairList& pairs, const neighbor::WallList& walls);

}  // namespace packmpi::observe
