/// What a sphere touches of a surface: a face, an edge or a corner of it, each by one formula of + - * / and
/// square root.
#pragma once
#include <cstdint>

namespace packmpi::mesh {

/// A surface as contacts read it. Faces are numbered first, then edges, then corners. Directions have length 1.
struct Table {
  const double* faces = nullptr;            ///< 4 each: normal out of the interior, offset
  const double* triangles = nullptr;        ///< 12 each: of three sides the direction into it, in its plane, and offset
  const double* edges = nullptr;            ///< 16 each: a point, direction, from, to; into both faces, with offsets
  const double* corners = nullptr;          ///< 3 each
  const double* spokes = nullptr;           ///< 4 each: the direction of an edge that begins at a corner, and offset
  const std::int32_t* spokes_of = nullptr;  ///< of each corner the first, and the end of the last
  const std::int32_t* patch = nullptr;      ///< of each feature: those that are smooth together have one, see Features
  std::int32_t edge_begin = 0, corner_begin = 0;  ///< numbers of the first edge and the first corner
  double deepest = 0.0;                           ///< [m] what is so far behind a face belongs to another interior
};

/// Towards a wall, and how far it is.
struct Touch {
  double normal[3];
  double distance;  ///< [m]; far_away if the sphere's nearest place of the feature is no inner one of it
};

inline constexpr double far_away = 1e100;

#define PACKMPI_CONTACT [[nodiscard]] [[gnu::always_inline]] inline

PACKMPI_CONTACT double along(const double* direction, const double* x) {
  return direction[0] * x[0] + direction[1] * x[1] + direction[2] * x[2];
}

/// Does the foot of x lie in one of the triangles `near` [begin, end)?
PACKMPI_CONTACT bool stands_on(const Table& table, const std::int32_t* near, std::int32_t begin, std::int32_t end,
                               const double* x) {
  for (std::int32_t k = begin; k < end; ++k) {
    const double* sides = table.triangles + 12 * std::int64_t{near[k]};
    if (along(sides, x) >= sides[3] && along(sides + 4, x) >= sides[7] && along(sides + 8, x) >= sides[11]) return true;
  }
  return false;
}

/// A face: of its triangles those that the sphere may be above have to be in `near`. Where it is `reach` [m] away or
/// more they are not looked at.
PACKMPI_CONTACT Touch touch_face(const Table& table, std::int32_t face, const std::int32_t* near, std::int32_t begin,
                                 std::int32_t end, const double* x, double reach) {
  const double* plane = table.faces + 4 * std::int64_t{face};
  const double distance = plane[3] - along(plane, x);
  const bool on = distance > -table.deepest && distance < reach && stands_on(table, near, begin, end, x);
  return {{plane[0], plane[1], plane[2]}, on ? distance : far_away};
}

/// From x towards `place`; on it the direction is zero.
PACKMPI_CONTACT Touch touch_place(const double* place, const double* x, bool on) {
  constexpr double tiny = 1e-300;  // [m2]
  const double d[3] = {place[0] - x[0], place[1] - x[1], place[2] - x[2]};
  const double distance = __builtin_sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + tiny);
  const double inverse = 1.0 / distance;
  return {{d[0] * inverse, d[1] * inverse, d[2] * inverse}, on ? distance : far_away};
}

/// An edge that sticks out into the interior, in the wedge that neither of its faces has.
PACKMPI_CONTACT Touch touch_edge(const Table& table, std::int32_t edge, const double* x) {
  const double* e = table.edges + 16 * std::int64_t{edge};
  const double u = along(e + 3, x);
  const bool on = u > e[6] && u < e[7] && along(e + 8, x) < e[11] && along(e + 12, x) < e[15];
  const double from = u - e[6];
  const double foot[3] = {e[0] + from * e[3], e[1] + from * e[4], e[2] + from * e[5]};
  return touch_place(foot, x, on);
}

/// A corner, where no edge goes on towards x.
PACKMPI_CONTACT Touch touch_corner(const Table& table, std::int32_t corner, const double* x) {
  bool on = true;
  for (std::int32_t k = table.spokes_of[corner]; k < table.spokes_of[corner + 1]; ++k) {
    const double* spoke = table.spokes + 4 * std::int64_t{k};
    on = on && along(spoke, x) <= spoke[3];
  }
  return touch_place(table.corners + 3 * std::int64_t{corner}, x, on);
}

/// Any feature; `near` is of faces only. What is `reach` [m] away or more may be far_away instead.
PACKMPI_CONTACT Touch touch(const Table& table, std::int32_t feature, const std::int32_t* near, std::int32_t begin,
                            std::int32_t end, const double* x, double reach) {
  if (feature < table.edge_begin) return touch_face(table, feature, near, begin, end, x, reach);
  if (feature < table.corner_begin) return touch_edge(table, feature - table.edge_begin, x);
  return touch_corner(table, feature - table.corner_begin, x);
}

#undef PACKMPI_CONTACT

}  // namespace packmpi::mesh
