/// Stage 2: the law over a block, pairs or walls. Plain loops without branches, which the compiler vectorises.
#pragma once
#include "dynamics/kernel_block.hpp"

namespace packmpi::dynamics::PACKMPI_KERNEL {

/// 1/r of both ends, their mean, and half of second - first [1/m].
struct Curvatures {
  double first, second, mean, half;
};

/// Torque over the radius [N] of the first and of the second; equal radii: the same curvature.
template <Features F>
PACKMPI_INLINE void put_moment(Block<F>& b, int p, int accumulator, double moment, double torque, double scale,
                               const Curvatures& k) {
  if constexpr (!F.rolling) {
    b.out[accumulator][p] = to_integer(moment * scale);
  } else {
    b.out[accumulator][p] = to_integer((moment + torque * k.first) * scale);
    b.own[accumulator][p] = to_integer((moment - torque * k.second) * scale);
  }
}

template <Features F>
PACKMPI_INLINE void put(Block<F>& b, int p, const Force& f, const Curvatures& k, double scale) {
  b.out[0][p] = to_integer(f.force.x * scale);
  b.out[1][p] = to_integer(f.force.y * scale);
  if constexpr (F.dimension == 3) b.out[2][p] = to_integer(f.force.z * scale);
  if constexpr (F.dimension == 2 && F.rotation) put_moment<F>(b, p, 2, f.moment.z, f.torque.z, scale, k);
  if constexpr (F.dimension == 3 && F.rotation) {
    put_moment<F>(b, p, 4, f.moment.x, f.torque.x, scale, k);
    put_moment<F>(b, p, 5, f.moment.y, f.torque.y, scale, k);
    put_moment<F>(b, p, 6, f.moment.z, f.torque.z, scale, k);
  }
  b.strength[p] = f.strength;
}

/// Of entry p: the scene's, or with several components those of its pair.
template <Features F>
PACKMPI_INLINE Constants constants_at(const Block<F>& b, int p, const Constants& all) {
  Constants c = all;
  if constexpr (F.mixture) {
    c.stiffness = b.law[0][p], c.damping = b.law[1][p], c.friction = b.law[2][p];
    c.shear_stiffness = b.law[3][p], c.shear_damping = b.law[4][p];
    c.rolling_friction = b.law[5][p], c.twisting_friction = b.law[6][p];
  }
  return c;
}

/// Three neighbouring rows, or in the plane two, or of a spin one.
template <Features F>
PACKMPI_INLINE Vector vector_at(const double (*rows)[Block<F>::row], int field, int p) {
  if constexpr (F.dimension == 3) return {rows[field][p], rows[field + 1][p], rows[field + 2][p]};
  return {rows[field][p], rows[field + 1][p], 0.0};
}
template <Features F>
PACKMPI_INLINE Vector spin_at(const double (*rows)[Block<F>::row], int p) {
  constexpr int field = F.layout().spin;
  if constexpr (!F.rotation) return {};
  if constexpr (F.dimension == 3) return vector_at<F>(rows, field, p);
  return {0.0, 0.0, rows[field][p]};
}

/// What contact p has stored.
template <Features F>
PACKMPI_INLINE Springs springs_at(const Block<F>& b, int p) {
  double values[scene::most_stored_doubles] = {};
  for (int c = 0; c < Memory<F>::stored; ++c) values[c] = b.stored[c][p];
  return springs_of<F>(values);
}

template <Features F>
PACKMPI_INLINE void put_springs(Block<F>& b, int p, const Springs& s) {
  const double all[] = {s.slip.x, s.slip.y, s.slip.z, s.roll.x, s.roll.y, s.roll.z, s.twist};
  for (int c = 0; c < Memory<F>::stored; ++c) b.stored[c][p] = all[F.dimension == 3 ? c : 3 * c];
}

/// From the sum and the difference: exchanging the ends exchanges them, bit for bit.
template <Features F>
PACKMPI_INLINE Curvatures curvatures_at(const Block<F>& b, int p, const Constants& c) {
  if constexpr (!F.graded) return {c.curvature, c.curvature, c.curvature, 0.0};
  constexpr int field = F.layout().curvature;
  const double sum = b.in[field][p];
  const double difference = b.again[field][p];
  return {0.5 * (sum - difference), 0.5 * (sum + difference), 0.5 * sum, 0.5 * difference};
}

/// The two ends of entry p as the law sees them, given where they touch.
template <Features F>
PACKMPI_INLINE Meeting meeting_at(const Block<F>& b, int p, const Constants& c, const Reduced& reduced,
                                  const Touch& at) {
  Meeting meeting = {reduced,
                     at.normal,
                     at.bend,
                     at.gap < 0.0 ? 0.0 : at.gap,
                     vector_at<F>(b.in, F.layout().velocity, p),
                     spin_at<F>(b.in, p),
                     {},
                     {}};
  if constexpr (F.rolling) {
    const Curvatures k = curvatures_at<F>(b, p, c);
    // k_j s_j - k_i s_i from sums and differences; of equal radii k (s_j - s_i).
    meeting.spin = scaled(k.mean, spin_at<F>(b.again, p));
    if constexpr (F.graded) meeting.spin = sum(meeting.spin, k.half, meeting.s);
  }
  return meeting;
}

/// Forces of entry p to integers, its springs to the rows.
template <Features F>
PACKMPI_INLINE void put_force(Block<F>& b, int p, const Constants& c, const Force& f, double scale) {
  Curvatures k = {};
  if constexpr (F.rolling) k = curvatures_at<F>(b, p, c);
  put<F>(b, p, f, k, scale);
  put_springs<F>(b, p, f.springs);
}

/// In 3D with memory the law is done in two loops: one would be a chain of roots and quotients longer than a processor
/// looks ahead. What the second needs of entry p takes the rows that the first has used up.
template <Features F>
PACKMPI_INLINE void put_pressed(Block<F>& b, int p, const Pressed& at, const Vector& spin) {
  constexpr int u = F.layout().velocity;
  b.in[0][p] = at.n.x, b.in[1][p] = at.n.y, b.in[2][p] = at.n.z;
  b.in[u][p] = at.u.x, b.in[u + 1][p] = at.u.y, b.in[u + 2][p] = at.u.z;
  b.in[F.layout().radius][p] = at.now.overlap;
  b.distance[p] = at.radius;
  b.pressed[0][p] = at.normal, b.pressed[1][p] = at.now.stiffness;
  b.pressed[2][p] = at.now.drag, b.pressed[3][p] = at.now.kept;
  constexpr int s = F.layout().spin;
  if constexpr (F.rolling) b.again[s][p] = spin.x, b.again[s + 1][p] = spin.y, b.again[s + 2][p] = spin.z;
}

template <Features F>
PACKMPI_INLINE void hold_all(Block<F>& b, const Constants& c, double scale) {
  constexpr int u = F.layout().velocity;
  const Constants k = c;
  const int filled = b.filled;
  for (int p = 0; p < filled; ++p) {
    const SpringState now = {0.0, b.pressed[1][p], b.pressed[2][p], b.pressed[3][p], b.in[F.layout().radius][p]};
    const Pressed at = {vector_at<F>(b.in, 0, p), b.pressed[0][p], vector_at<F>(b.in, u, p), now, b.distance[p]};
    Vector spin = {};
    if constexpr (F.rolling) spin = spin_at<F>(b.again, p);
    put_force<F>(b, p, k, hold_3d<F>(constants_at<F>(b, p, k), at, spin, springs_at<F>(b, p)), scale);
  }
}

/// The contact of entry p, or what comes before hold_all().
template <Features F>
PACKMPI_INLINE void contact(Block<F>& b, int p, const Constants& c, const Reduced& reduced, const Touch& at,
                            double scale) {
  Meeting meeting = meeting_at<F>(b, p, c, reduced, at);
  if constexpr (Block<F>::M::two_loops) {
    put_pressed<F>(b, p, press_3d<F>(c, meeting), meeting.spin);
  } else {
    meeting.springs = springs_at<F>(b, p);
    put_force<F>(b, p, c, F.dimension == 3 ? contact_3d<F>(c, meeting) : contact_2d<F>(c, meeting), scale);
  }
}

/// Normals and distances of all pairs. A loop of its own, as every root of the law waits for these, and a processor
/// looks ahead too little to begin the next entries meanwhile.
template <Features F>
PACKMPI_INLINE void separate(Block<F>& b, const Periods& periods) {
  const Periods w = periods;
  const int filled = b.filled;
  for (int p = 0; p < filled; ++p) {
    double x = b.in[0][p];
    double y = b.in[1][p];
    const double z = F.dimension == 3 ? b.in[2][p] : 0.0;
    if constexpr (F.periodic) {
      x = shortest(x, w.period[0], w.half[0]);
      if constexpr (F.dimension == 3) y = shortest(y, w.period[1], w.half[1]);
    }
    double square = x * x + y * y;
    if constexpr (F.dimension == 3) square = square + z * z;
    const Separation apart = separation(x, y, z, square);
    b.in[0][p] = apart.normal.x, b.in[1][p] = apart.normal.y;
    if constexpr (F.dimension == 3) b.in[2][p] = apart.normal.z;
    b.distance[p] = apart.distance;
    if constexpr (F.memory) b.bend[p] = apart.inverse;
  }
}

/// What the first end of entry p meets: another particle, or a wall.
enum class Other : std::uint8_t { particle, wall };

template <Features F, Other other>
PACKMPI_INLINE Reduced reduced_at(const Block<F>& b, int p, const Constants& c) {
  constexpr particles::Layout layout = F.layout();
  if constexpr (!F.graded) return {c.reduced_radius, c.reduced_mass};
  const double curvature = b.in[layout.curvature][p];
  const double radius = b.in[layout.radius][p];
  if constexpr (F.mixture) {
    const double inverse_mass = b.in[layout.component + 1][p];
    return other == Other::particle ? reduced_of_mixed(curvature, inverse_mass) : Reduced{radius, 1.0 / inverse_mass};
  } else {
    return other == Other::particle ? reduced_of_pair(c.mass_factor, curvature, radius)
                                    : reduced_of_wall(c.mass_factor, curvature, radius);
  }
}

/// All contacts of the block; rows 0 .. dimension-1 of `in` hold the normal, `distance` that of the centres, or of one
/// from the wall's surface, negative beyond it.
template <Features F, Other other>
PACKMPI_INLINE void resolve(Block<F>& b, const Constants& c, double scale) {
  const Constants k = c;
  const int filled = b.filled;
  for (int p = 0; p < filled; ++p) {
    double bend = 0.0;
    if constexpr (F.memory && other == Other::particle) bend = b.bend[p];
    const Touch at = {vector_at<F>(b.in, 0, p), bend, b.in[F.layout().radius][p] - b.distance[p]};
    contact<F>(b, p, constants_at<F>(b, p, k), reduced_at<F, other>(b, p, k), at, scale);
  }
  if constexpr (Block<F>::M::two_loops) hold_all<F>(b, c, scale);
}

}  // namespace packmpi::dynamics::PACKMPI_KERNEL
