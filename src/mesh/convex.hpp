/// What stands for the walls of a convex interior: one triangle a face.
#pragma once
#include <vector>

#include "mesh/surface.hpp"

namespace packmpi::mesh {

/// A triangle over each face, in the order of their numbers: it has no edge inside the interior. Empty if the interior
/// is not convex. Cost: O(triangles * faces).
[[nodiscard]] std::vector<Corners> triangles_over_faces(const Surface& surface);

}  // namespace packmpi::mesh
