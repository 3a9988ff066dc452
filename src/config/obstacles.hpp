/// What stands or hangs in a vessel: the vessel becomes a mesh that has it as holes. Private to this module.
#pragma once
#include <memory>
#include <vector>

#include "config/input.hpp"
#include "document/document.hpp"
#include "mesh/read.hpp"
#include "tables/sieve_table.hpp"

namespace packmpi::input {

/// The surface of a vessel that is no mesh, up to H_d, as triangles [m]; round walls in facets (mesh/bodies.hpp).
/// Throws Error(bad_input) if it is periodic or in 2D.
[[nodiscard]] std::vector<mesh::Corners> drawn_vessel(const document::Document& document, const Input& in);

/// Of each obstacle the triangles, all of them moved by `shift` [m]. Throws Error(bad_input).
[[nodiscard]] std::vector<std::vector<mesh::Corners>> drawn_obstacles(const Input& in,
                                                                      const std::vector<tables::CurveFile>& files,
                                                                      const Vec3& shift);

/// The interior that they leave of a vessel. Throws Error(bad_input) of the first obstacle that does not lie inside it,
/// clear of its walls and of the others. Cost: O(triangles).
[[nodiscard]] std::shared_ptr<const mesh::Surface> interior_around(
    const Input& in, const mesh::Surface& vessel, const std::vector<std::vector<mesh::Corners>>& obstacles);

}  // namespace packmpi::input
