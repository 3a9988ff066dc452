/// A closed surface of triangles that share their corners: what a file has, checked and mended.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mesh/read.hpp"

namespace packmpi::mesh {

/// What was mended, to be told.
struct Mended {
  std::int64_t dropped = 0;  ///< triangles without an area
  std::int64_t turned = 0;   ///< triangles that looked inside
  int parts = 1;             ///< closed surfaces, of which those inside others are holes in the interior
};

/// Closed: each edge belongs to two triangles. Their corners go anticlockwise for who looks from outside the interior.
struct Shell {
  std::vector<Vec3> points;                    ///< [m]
  std::vector<std::array<int, 3>> triangles;   ///< three of the points each
  std::vector<std::array<int, 3>> neighbours;  ///< across the edges that begin at the corners
  Vec3 low{}, high{};                          ///< [m] the box around it
  double tolerance = 0.0;                      ///< [m] points nearer than this are one: 1e-6 of the largest extent
  Mended mended;

  [[nodiscard]] Corners corners(std::size_t triangle) const {
    const auto& t = triangles[triangle];
    return {points[static_cast<std::size_t>(t[0])], points[static_cast<std::size_t>(t[1])],
            points[static_cast<std::size_t>(t[2])]};
  }
  [[nodiscard]] double volume() const;                    ///< [m3] of the interior
  [[nodiscard]] Vec3 normal(std::size_t triangle) const;  ///< out of the interior, twice as long as the area [m2]
  /// Not higher than the tolerance: it has a place in the surface, and no plane of its own.
  [[nodiscard]] bool is_needle(std::size_t triangle) const;
};

/// Joins corners that are nearer than the tolerance, drops triangles that then have no three, turns triangles that look
/// inside. Throws Error(bad_input) that begins with `name` if the surface is open, has an edge of three triangles or
/// more, one side only, no volume, or cuts itself. Pure. Cost: O(triangles) but for ill-shaped ones.
[[nodiscard]] Shell close(const std::vector<Corners>& triangles, const std::string& name);

/// Its points and triangles as the lines of an OBJ file: read again they are the same doubles.
[[nodiscard]] std::string obj_text(const Shell& shell);
/// Its triangles as STL in text.
[[nodiscard]] std::string text_stl(const Shell& shell);

/// Two triangles that meet where they share nothing; {-1, -1}: there are none. Private to this module.
[[nodiscard]] std::array<int, 2> first_crossing(const Shell& shell);

}  // namespace packmpi::mesh
