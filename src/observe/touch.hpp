/// Where two particles, or a particle and a wall, touch.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "geometry/container.hpp"
#include "neighbor/lists.hpp"
#include "particles/store.hpp"

namespace packmpi::observe {

/// The gap between two particles, seen from `i`.
struct Touch {
  double overlap;  ///< r_i + r_j - distance [m]; positive: they touch
  Vec3 normal;     ///< unit vector from i to j, shortest image; zero if the centres coincide
};

/// Slots i and j, owned or ghosts. Antisymmetric to the last bit: the same overlap from either side.
[[nodiscard]] inline Touch touch(const particles::Store& store, const geometry::Container& box, LocalIndex i,
                                 LocalIndex j) {
  const Vec3 d = geometry::separation(box, store.position(i), store.position(j));
  const double distance = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  const double inverse = distance > 0.0 ? 1.0 / distance : 0.0;
  return {store.radius(i) + store.radius(j) - distance, {d[0] * inverse, d[1] * inverse, d[2] * inverse}};
}

/// Is this listed pair this rank's to count? One rank counts each: of a pair across a border the owner of the smaller
/// id; of one with a frozen particle (ids below `frozen_below`), the mover's. `i` is owned.
[[nodiscard]] inline bool is_counted_here(const particles::Store& store, LocalIndex i, LocalIndex j,
                                          GlobalId frozen_below) {
  const GlobalId other = store.ids()[static_cast<std::size_t>(j)];
  return j < store.owned() || other < frozen_below || store.ids()[static_cast<std::size_t>(i)] < other;
}

/// Calls take(entry, i, j, overlap [m]) for each listed pair that touches, in the order of the list.
template <class Take>
void each_touching(const particles::Store& store, const geometry::Container& box, const neighbor::PairList& pairs,
                   Take&& take) {
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    const double overlap = touch(store, box, pairs.first[p], pairs.second[p]).overlap;
    if (overlap > 0.0) take(static_cast<std::int64_t>(p), pairs.first[p], pairs.second[p], overlap);
  }
}

/// Calls take(entry, i, wall, facing) for each particle that touches a wall, in the order of the list.
template <class Take>
void each_touching_wall(const particles::Store& store, const geometry::Container& box, const neighbor::WallList& walls,
                        Take&& take) {
  for (std::size_t w = 0; w < walls.particle.size(); ++w) {
    const LocalIndex i = walls.particle[w];
    const geometry::Facing at = neighbor::facing_of(box, walls, w, store.position(i));
    if (at.distance < store.radius(i)) take(static_cast<std::int64_t>(w), i, walls.wall[w], at);
  }
}

}  // namespace packmpi::observe
