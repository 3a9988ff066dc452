#include "observe/deepest.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "observe/touch.hpp"

namespace packmpi::observe {

Deepest deepest(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                const neighbor::PairList& pairs, const neighbor::WallList& walls) {
  constexpr GlobalId nobody = std::numeric_limits<GlobalId>::max();
  Deepest mine{.overlap = 0.0, .first = nobody, .second = nobody, .at = {}};
  const auto take = [&](double overlap, GlobalId first, GlobalId second, const Vec3& at) {
    const bool earlier = std::pair(first, second) < std::pair(mine.first, mine.second);
    if (overlap > mine.overlap || (overlap == mine.overlap && earlier)) mine = {overlap, first, second, at};
  };
  const auto id = [&](LocalIndex i) { return store.ids()[static_cast<std::size_t>(i)]; };
  each_touching(store, scene.container, pairs, [&](std::int64_t, LocalIndex i, LocalIndex j, double overlap) {
    if (id(j) < id(i)) std::swap(i, j);
    take(overlap / std::min(store.radius(i), store.radius(j)), id(i), id(j), store.position(i));
  });
  each_touching_wall(store, scene.container, walls,
                     [&](std::int64_t, LocalIndex i, neighbor::Wall, const geometry::Facing& at) {
                       take((store.radius(i) - at.distance) / store.radius(i), id(i), nobody, store.position(i));
                     });
  Deepest found{.overlap = comm.max(mine.overlap), .first = -1, .second = -1, .at = {}};
  if (!(found.overlap > 0.0)) return found;
  const bool same = mine.overlap == found.overlap;
  found.first = comm.min(same ? mine.first : nobody);
  const bool first = same && mine.first == found.first;
  const GlobalId second = comm.min(first ? mine.second : nobody);
  found.second = second == nobody ? -1 : second;
  found.at.fill(-std::numeric_limits<double>::infinity());
  if (first && mine.second == second) found.at = mine.at;
  comm.max(std::span(found.at));
  return found;
}

}  // namespace packmpi::observe
