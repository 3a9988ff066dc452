/// Vessels of triangles: from a file, or from the lines that stand in a scene.
#pragma once
#include <optional>

#include "asked/input.hpp"
#include "document/document.hpp"
#include "tables/sieve_table.hpp"

namespace packmpi::input {

/// Reads the surface of a mesh, from what its file holds (none: no file was read) or from the scene itself, and puts it
/// where the scene's own stands. Throws Error(bad_input).
void take_mesh(const document::Document& document, const std::optional<tables::CurveFile>& file, Input& in);

}  // namespace packmpi::input
