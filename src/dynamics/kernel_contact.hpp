/// The contact law of one pair or wall, branch-free: the body of the loops that the compiler vectorises.
/// Exactly antisymmetric: exchanging the ends negates the force and keeps the moment, bit for bit.
#pragma once
#include "dynamics/kernel_lanes.hpp"
#include "dynamics/law.hpp"

namespace packmpi::dynamics::PACKMPI_KERNEL {

using scene::Features;

/// The law's constants as the loops want them.
struct Constants {
  double stiffness, damping, friction;
  double reduced_radius, reduced_mass;  // equal radii
  double mass_factor;
  double spin_slip;
  double slip;  // slip_mass * slip_rate: a friction force of slip * m* * |u| stops (or damps) the slip
  double lowest_force;
};

PACKMPI_INLINE Constants constants_of(const Law& law, const LawConstants& c) {
  return {c.stiffness,     c.damping,       c.friction,    c.reduced_radius,
          c.reduced_mass,  law.mass_factor, law.spin_slip, law.slip_mass * law.slip_rate,
          law.lowest_force};
}

struct Vector {
  double x, y, z;  // 2D: z is unused; of a spin, z alone is used
};

/// Force on the first [N], moment over radius q = n x f_t on both [N], and |normal force| [N], not finite if the state
/// is not.
struct Force {
  Vector force, moment;
  double strength;
};

/// Reduced radius [m] and mass [kg].
struct Reduced {
  double radius, mass;
};

/// From K = k_i + k_j and S = r_i + r_j: 1/r* = K, 1/m* = mass_factor K^2 (K - 3/S), with one division.
PACKMPI_INLINE Reduced reduced_of_pair(double mass_factor, double curvature, double radius) {
  const double a = mass_factor * curvature * curvature * (curvature * radius - 3.0);
  const double b = 1.0 / (a * curvature);
  return {a * b, radius * curvature * b};
}

PACKMPI_INLINE Reduced reduced_of_wall(double mass_factor, double curvature, double radius) {
  return {radius, 1.0 / (mass_factor * curvature * curvature * curvature)};
}

/// Normal force: 0 without overlap. Comparisons are written so that a NaN passes through them.
PACKMPI_INLINE double normal_force(const Constants& c, const Reduced& reduced, double overlap, double rate) {
  const double contact = root(reduced.radius * overlap);
  const double force = c.stiffness * contact * overlap + c.damping * root(reduced.mass * contact) * rate;
  return force < c.lowest_force ? c.lowest_force : force;
}

/// n from first to second, u = v_second - v_first, s = sum of r omega.
template <Features F>
PACKMPI_INLINE Force contact_3d(const Constants& c, const Reduced& reduced, const Vector& n, double overlap,
                                const Vector& v, const Vector& s) {
  const double rate = -(v.x * n.x + v.y * n.y + v.z * n.z);
  const double normal = normal_force(c, reduced, overlap, rate);
  const double strength = magnitude(normal);
  if constexpr (!F.friction) {
    return {{-(normal * n.x), -(normal * n.y), -(normal * n.z)}, {}, strength};
  } else {
    Vector u = {v.x + rate * n.x, v.y + rate * n.y, v.z + rate * n.z};
    if constexpr (F.rotation) {
      u.x = u.x - c.spin_slip * (s.y * n.z - s.z * n.y);
      u.y = u.y - c.spin_slip * (s.z * n.x - s.x * n.z);
      u.z = u.z - c.spin_slip * (s.x * n.y - s.y * n.x);
    }
    const double square = u.x * u.x + u.y * u.y + u.z * u.z + tiny;
    const double sliding = c.friction * strength / root(square);
    const double stopping = c.slip * reduced.mass;
    const double slope = sliding < stopping ? sliding : stopping;
    const Vector t = {slope * u.x, slope * u.y, slope * u.z};
    return {{t.x - normal * n.x, t.y - normal * n.y, t.z - normal * n.z},
            {n.y * t.z - n.z * t.y, n.z * t.x - n.x * t.z, n.x * t.y - n.y * t.x},
            strength + 0.0 * square};
  }
}

/// In the plane the tangent is (-n_y, n_x) and the slip a number along it: no root, no quotient.
template <Features F>
PACKMPI_INLINE Force contact_2d(const Constants& c, const Reduced& reduced, const Vector& n, double overlap,
                                const Vector& v, double s) {
  const double rate = -(v.x * n.x + v.y * n.y);
  const double normal = normal_force(c, reduced, overlap, rate);
  const double strength = magnitude(normal);
  if constexpr (!F.friction) {
    return {{-(normal * n.x), -(normal * n.y), 0.0}, {}, strength};
  } else {
    double u = v.y * n.x - v.x * n.y;
    if constexpr (F.rotation) u = u - c.spin_slip * s;
    const double sliding = c.friction * strength;
    const double stopping = c.slip * reduced.mass * magnitude(u);
    const double t = with_sign_of(sliding < stopping ? sliding : stopping, u);
    return {{-(t * n.y) - normal * n.x, t * n.x - normal * n.y, 0.0}, {0.0, 0.0, t}, strength + 0.0 * u};
  }
}

}  // namespace packmpi::dynamics::PACKMPI_KERNEL
