/// Walls that are no planes across an axis, in scripts for YADE. Private to this module.
#pragma once
#include <string>
#include <vector>

#include "exporters/document.hpp"
#include "mesh/surface.hpp"

namespace packmpi::exporters::yade {

/// Python: `push_off_round_walls()`, to be called in each step between contacts and motion, and the table
/// `round_springs` of the forces of friction on spheres [N], by body and number of the wall. Needs `ids`, and `newton`,
/// the engine that moves. Of a vessel that has such walls.
[[nodiscard]] std::string round_walls(const Specimen& specimen);

/// What stands for a mesh: of a convex interior a triangle over each face, in the order of their numbers; of others
/// each triangle. Over a seam of two of them a sphere is touched twice. Cost: O(triangles * faces).
[[nodiscard]] std::vector<mesh::Corners> facets(const mesh::Surface& surface);
/// Of a polygon a triangle over each sloping side, in their order, with no edge where a particle can be.
[[nodiscard]] std::vector<mesh::Corners> facets(const Specimen& specimen);

}  // namespace packmpi::exporters::yade
