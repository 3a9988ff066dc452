/// The Verlet lists of one rank: which pairs and walls may touch before the next rebuild.
#pragma once
#include <cstdint>
#include <vector>

#include "base/types.hpp"
#include "geometry/container.hpp"

namespace packmpi::neighbor {

/// A wall of the container.
using Wall = geometry::Surface;

/// Half list: each pair that has an owned end once. first[p] is an owned slot, ascending in p; second[p] > first[p], an
/// owned or a ghost slot (>= Store::owned()). A pair across a rank border is listed on both ranks, each with its own
/// particle first. Distance at the rebuild < sum of their radii and margins.
struct PairList {
  std::vector<LocalIndex> first;
  std::vector<LocalIndex> second;
  LocalIndex window = 1;  ///< 1 + largest second - first over pairs of two owned particles
};

/// Owned particles within their margin of a wall, ascending in particle; one entry for each (particle, wall).
struct WallList {
  std::vector<LocalIndex> particle;
  std::vector<Wall> wall;
  /// Of a mesh: triangles of its faces that each entry's particle may be above, `near` from near_begin[entry] up to
  /// near_begin[entry + 1]. Of other containers both are empty.
  std::vector<std::int32_t> near_begin, near;
  /// Of a mesh or a polygon, where each entry's wall is: see Neighborhood::face_walls. Of other containers empty.
  std::vector<geometry::Facing> facing;
};

/// Where the wall of an entry of a list is, seen from its particle at `x`.
[[nodiscard]] inline geometry::Facing facing_of(const geometry::Container& box, const WallList& walls,
                                                std::size_t entry, const Vec3& x) {
  return walls.facing.empty() ? box.facing(walls.wall[entry], x) : walls.facing[entry];
}

}  // namespace packmpi::neighbor
