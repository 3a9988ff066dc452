/// Triangles out of a file of CAD programs: STL, in text or in binary, and OBJ.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/types.hpp"

namespace packmpi::mesh {

using Corners = std::array<Vec3, 3>;

inline constexpr std::int64_t most_bytes = std::int64_t{1} << 29;  ///< of a file
inline constexpr std::int64_t most_triangles = 2'000'000;

/// The triangles of a file that holds `bytes`, in its own units and as it has them. `path` says by its ending what it
/// is, .stl or .obj. Single precision of binary STL is taken for the shortest decimal that it stands for, so that 0.1
/// is the same in text and in binary. Faces of OBJ with more corners are cut from their first one. Pure. Throws
/// Error(bad_input) that begins with `path`.
[[nodiscard]] std::vector<Corners> read_triangles(std::string_view bytes, const std::string& path);

/// Can this be the path of such a file?
[[nodiscard]] bool names_mesh(std::string_view path) noexcept;

/// Those triangles as binary STL [their own units].
[[nodiscard]] std::string binary_stl(const std::vector<Corners>& triangles);

}  // namespace packmpi::mesh
