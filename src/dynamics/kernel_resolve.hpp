/// Stage 2: the law over a block, pairs or walls. Plain loops without branches, which the compiler vectorises.
#pragma once
#include "dynamics/kernel_block.hpp"

namespace packmpi::dynamics::PACKMPI_KERNEL {

/// Periods for the shortest image; an axis with walls has one too large to matter.
struct Periods {
  double period[2], half[2];
};

PACKMPI_INLINE Periods periods_of(const StepData& data) {
  Periods p{};
  for (unsigned axis = 0; axis < 2; ++axis) {
    p.period[axis] = data.periodic[axis] ? data.size[axis] : 0.0;
    p.half[axis] = data.periodic[axis] ? 0.5 * data.size[axis] : __builtin_inf();
  }
  return p;
}

/// geometry::shortest, with the half period at hand.
PACKMPI_INLINE double shortest(double d, double period, double half) {
  d = d > half ? d - period : d;
  return d < -half ? d + period : d;
}

template <Features F>
PACKMPI_INLINE void put(Block& b, int p, const Force& f, double scale) {
  b.out[0][p] = to_integer(f.force.x * scale);
  b.out[1][p] = to_integer(f.force.y * scale);
  if constexpr (F.dimension == 3) b.out[2][p] = to_integer(f.force.z * scale);
  if constexpr (F.dimension == 2 && F.rotation) b.out[2][p] = to_integer(f.moment.z * scale);
  if constexpr (F.dimension == 3 && F.rotation) {
    b.out[4][p] = to_integer(f.moment.x * scale);
    b.out[5][p] = to_integer(f.moment.y * scale);
    b.out[6][p] = to_integer(f.moment.z * scale);
  }
  b.strength[p] = f.strength;
}

/// The contact of entry p, given its normal and overlap.
template <Features F>
PACKMPI_INLINE void contact(Block& b, int p, const Constants& c, const Reduced& reduced, const Vector& n,
                            double overlap, double scale) {
  constexpr particles::Layout layout = F.layout();
  constexpr int v = layout.velocity - Block::places;
  constexpr int s = F.rotation ? layout.spin - Block::places : v;
  if constexpr (F.dimension == 3) {
    put<F>(b, p,
           contact_3d<F>(c, reduced, n, overlap, {b.in[v][p], b.in[v + 1][p], b.in[v + 2][p]},
                         {b.in[s][p], b.in[s + 1][p], b.in[s + 2][p]}),
           scale);
  } else {
    put<F>(b, p, contact_2d<F>(c, reduced, n, overlap, {b.in[v][p], b.in[v + 1][p], 0.0}, b.in[s][p]), scale);
  }
}

/// Curvature of entry p: the sum over the pair, or that of the particle at a wall.
template <Features F>
PACKMPI_INLINE double curvature_at(const Block& b, int p) {
  constexpr int field = F.layout().curvature;
  if constexpr (field < Block::places) {
    return b.place[field][p];
  } else {
    return b.in[field - Block::places][p];
  }
}

/// Where two particles meet.
struct Touch {
  Vector normal;
  double gap;  // the overlap; negative: they do not touch
};

/// Of two particles at a distance of (x, y, z), whose square is given; their radii add up to `radius`.
PACKMPI_INLINE Touch touch(double x, double y, double z, double square, double radius) {
  const double distance = root(square + tiny);
  const double inverse = 1.0 / distance;
  return {{x * inverse, y * inverse, z * inverse}, radius - distance};
}

/// All pairs of the block.
template <Features F>
PACKMPI_INLINE void resolve_pairs(Block& b, const Constants& c, const Periods& periods, double scale) {
  constexpr particles::Layout layout = F.layout();
  const Constants k = c;
  const Periods w = periods;
  const int filled = b.filled;
  for (int p = 0; p < filled; ++p) {
    double x = b.place[0][p];
    double y = b.place[1][p];
    const double z = F.dimension == 3 ? b.place[2][p] : 0.0;
    if constexpr (F.periodic) {
      x = shortest(x, w.period[0], w.half[0]);
      if constexpr (F.dimension == 3) y = shortest(y, w.period[1], w.half[1]);
    }
    double square = x * x + y * y;
    if constexpr (F.dimension == 3) square = square + z * z;
    const double radius = b.place[layout.radius][p];
    const Touch at = touch(x, y, z, square, radius);
    const double overlap = at.gap < 0.0 ? 0.0 : at.gap;
    Reduced reduced = {k.reduced_radius, k.reduced_mass};
    if constexpr (F.graded) reduced = reduced_of_pair(k.mass_factor, curvature_at<F>(b, p), radius);
    contact<F>(b, p, k, reduced, at.normal, overlap, scale);
  }
}

/// All wall contacts of the block; rows 0 .. dimension-1 of `place` hold the normal, towards the wall, the last one the
/// distance of the centre from the plane, negative beyond it.
template <Features F>
PACKMPI_INLINE void resolve_walls(Block& b, const Constants& c, double scale) {
  constexpr particles::Layout layout = F.layout();
  const Constants k = c;
  const int filled = b.filled;
  for (int p = 0; p < filled; ++p) {
    const Vector n = {b.place[0][p], b.place[1][p], F.dimension == 3 ? b.place[2][p] : 0.0};
    const double radius = b.place[layout.radius][p];
    const double gap = radius - b.place[Block::places][p];
    const double overlap = gap < 0.0 ? 0.0 : gap;
    Reduced reduced = {k.reduced_radius, k.reduced_mass};
    if constexpr (F.graded) reduced = reduced_of_wall(k.mass_factor, curvature_at<F>(b, p), radius);
    contact<F>(b, p, k, reduced, n, overlap, scale);
  }
}

}  // namespace packmpi::dynamics::PACKMPI_KERNEL
