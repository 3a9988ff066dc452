/// Vessels of triangles: from a file, or from the lines that stand in a scene.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "config/input.hpp"
#include "document/document.hpp"
#include "tables/sieve_table.hpp"

namespace packmpi::input {

/// What a unit of a file is [m]. Throws Error(bad_input) of the key at `place`.
[[nodiscard]] double metres(const std::string& place, std::string_view key, const std::string& unit);

/// The path of a file that the scene at `scene` names.
[[nodiscard]] std::string beside(const std::string& scene, const std::string& name);

/// Reads the surface of a mesh, from the files that came with the scene or from the scene itself, and puts it where the
/// scene's own stands; with obstacles, every vessel becomes a mesh that has them as holes. Throws Error(bad_input).
void take_mesh(const document::Document& document, const std::vector<tables::CurveFile>& files, Input& in);

}  // namespace packmpi::input
