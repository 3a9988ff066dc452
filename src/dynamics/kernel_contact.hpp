/// The contact law of one pair or wall, branch-free: the body of the loops that the compiler vectorises.
/// Exactly antisymmetric: exchanging the ends negates the force and keeps the moment, bit for bit.
/// Real is double, or float in scenes of mixed precision.
#pragma once
#include <type_traits>

#include "dynamics/kernel_lanes.hpp"
#include "dynamics/law.hpp"

namespace packmpi::dynamics::PACKMPI_KERNEL {

using scene::Features;

template <Features F>
using Real = std::conditional_t<F.mixed, float, double>;

/// The law's constants as the loops want them.
template <class R>
struct Constants {
  R stiffness, damping, friction;
  R reduced_radius, reduced_mass;  // equal radii
  R mass_factor;
  R spin_slip;
  R slip;  // slip_mass * slip_rate: a friction force of slip * m* * |u| stops (or damps) the slip
  R lowest_force;
};

template <class R>
PACKMPI_INLINE Constants<R> constants_of(const Law& law, const LawConstants& c) {
  const double slip = law.slip_mass * law.slip_rate;
  const double most = largest_number<R>();
  return {static_cast<R>(c.stiffness),     static_cast<R>(c.damping),
          static_cast<R>(c.friction),      static_cast<R>(c.reduced_radius),
          static_cast<R>(c.reduced_mass),  static_cast<R>(law.mass_factor),
          static_cast<R>(law.spin_slip),   static_cast<R>(slip < most ? slip : most),
          static_cast<R>(law.lowest_force)};
}

template <class R>
struct Vector {
  R x, y, z;  // 2D: z is unused; of a spin, z alone is used
};

/// Force on the first [N], moment over radius q = n x f_t on both [N], and |normal force| [N], not finite if the state
/// is not.
template <class R>
struct Force {
  Vector<R> force, moment;
  R strength;
};

/// Reduced radius [m] and mass [kg].
template <class R>
struct Reduced {
  R radius, mass;
};

/// From K = k_i + k_j and S = r_i + r_j: 1/r* = K, 1/m* = mass_factor K^2 (K - 3/S), with one division.
template <class R>
PACKMPI_INLINE Reduced<R> reduced_of_pair(R mass_factor, R curvature, R radius) {
  const R a = mass_factor * curvature * curvature * (curvature * radius - R{3});
  const R b = R{1} / (a * curvature);
  return {a * b, radius * curvature * b};
}

template <class R>
PACKMPI_INLINE Reduced<R> reduced_of_wall(R mass_factor, R curvature, R radius) {
  return {radius, R{1} / (mass_factor * curvature * curvature * curvature)};
}

/// Normal force: 0 without overlap. Comparisons are written so that a NaN passes through them.
template <class R>
PACKMPI_INLINE R normal_force(const Constants<R>& c, const Reduced<R>& reduced, R overlap, R rate) {
  const R contact = root(reduced.radius * overlap);
  const R force = c.stiffness * contact * overlap + c.damping * root(reduced.mass * contact) * rate;
  return force < c.lowest_force ? c.lowest_force : force;
}

/// n from first to second, u = v_second - v_first, s = sum of r omega.
template <Features F, class R>
PACKMPI_INLINE Force<R> contact_3d(const Constants<R>& c, const Reduced<R>& reduced, const Vector<R>& n, R overlap,
                                   const Vector<R>& v, const Vector<R>& s) {
  const R rate = -(v.x * n.x + v.y * n.y + v.z * n.z);
  const R normal = normal_force(c, reduced, overlap, rate);
  const R strength = magnitude(normal);
  if constexpr (!F.friction) {
    return {{-(normal * n.x), -(normal * n.y), -(normal * n.z)}, {}, strength};
  } else {
    Vector<R> u = {v.x + rate * n.x, v.y + rate * n.y, v.z + rate * n.z};
    if constexpr (F.rotation) {
      u.x = u.x - c.spin_slip * (s.y * n.z - s.z * n.y);
      u.y = u.y - c.spin_slip * (s.z * n.x - s.x * n.z);
      u.z = u.z - c.spin_slip * (s.x * n.y - s.y * n.x);
    }
    const R square = u.x * u.x + u.y * u.y + u.z * u.z + tiny<R>();
    const R sliding = c.friction * strength / root(square);
    const R stopping = c.slip * reduced.mass;
    const R slope = sliding < stopping ? sliding : stopping;
    const Vector<R> t = {slope * u.x, slope * u.y, slope * u.z};
    return {{t.x - normal * n.x, t.y - normal * n.y, t.z - normal * n.z},
            {n.y * t.z - n.z * t.y, n.z * t.x - n.x * t.z, n.x * t.y - n.y * t.x},
            strength + R{0} * square};
  }
}

/// In the plane the tangent is (-n_y, n_x) and the slip a number along it: no root, no quotient.
template <Features F, class R>
PACKMPI_INLINE Force<R> contact_2d(const Constants<R>& c, const Reduced<R>& reduced, const Vector<R>& n, R overlap,
                                   const Vector<R>& v, R s) {
  const R rate = -(v.x * n.x + v.y * n.y);
  const R normal = normal_force(c, reduced, overlap, rate);
  const R strength = magnitude(normal);
  if constexpr (!F.friction) {
    return {{-(normal * n.x), -(normal * n.y), R{0}}, {}, strength};
  } else {
    R u = v.y * n.x - v.x * n.y;
    if constexpr (F.rotation) u = u - c.spin_slip * s;
    const R sliding = c.friction * strength;
    const R stopping = c.slip * reduced.mass * magnitude(u);
    const R t = with_sign_of(sliding < stopping ? sliding : stopping, u);
    return {{-(t * n.y) - normal * n.x, t * n.x - normal * n.y, R{0}}, {R{0}, R{0}, t}, strength + R{0} * u};
  }
}

}  // namespace packmpi::dynamics::PACKMPI_KERNEL
