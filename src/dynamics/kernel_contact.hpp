/// The contact law of one pair or wall, branch-free: the body of the loops that the compiler vectorises.
/// Exactly antisymmetric: exchanging the ends negates the force and keeps the moment, bit for bit; of what is stored,
/// scene::storings tells which is negated.
#pragma once
#include "dynamics/kernel_lanes.hpp"
#include "dynamics/law.hpp"
#include "scene/pair_channels.hpp"

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
  double shear_stiffness, shear_damping, rolling_friction, twisting_friction;  // friction with memory
  double time_step;
  double curvature;  // 1/r, equal radii
};

PACKMPI_INLINE Constants constants_of(const Law& law, const LawConstants& c, double time_step) {
  return {c.stiffness,
          c.damping,
          c.friction,
          c.reduced_radius,
          c.reduced_mass,
          law.mass_factor,
          law.spin_slip,
          law.slip_mass * law.slip_rate,
          law.lowest_force,
          c.shear_stiffness,
          c.shear_damping,
          c.rolling_friction,
          c.twisting_friction,
          time_step,
          1.0 / law.wall.reduced_radius};
}

struct Vector {
  double x, y, z;  // 2D: z is unused; of a spin, z alone is used
};

PACKMPI_INLINE double dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
PACKMPI_INLINE Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
PACKMPI_INLINE Vector scaled(double f, const Vector& a) { return {f * a.x, f * a.y, f * a.z}; }
/// a + f b
PACKMPI_INLINE Vector sum(const Vector& a, double f, const Vector& b) {
  return {a.x + f * b.x, a.y + f * b.y, a.z + f * b.z};
}

/// Reduced radius [m] and mass [kg].
struct Reduced {
  double radius, mass;
};

/// What is stored for a contact [m], oriented from the first end: the displacements of the tangential, rolling and
/// twisting springs. In 2D the first components alone are used.
struct Springs {
  Vector slip, roll;
  double twist;
};

/// Two ends where they touch. n: unit normal from the first to the second.
struct Meeting {
  Reduced reduced;
  Vector n;
  double bend;     // 1 / distance of the centres; 0 at a flat wall [1/m]
  double overlap;  // 0 if they do not touch [m]
  Vector v;        // v_second - v_first [m/s]
  Vector s;        // sum of r omega [m/s]
  Vector spin;     // omega_second - omega_first [rad/s]; rolling only
  Springs springs;
};

/// Force on the first [N]; moment over radius q = n x f_t on both [N]; torque on the first, its negative on the second
/// [N m]; |normal force| [N], not finite if the state is not; the springs after the step.
struct Force {
  Vector force, moment, torque;
  double strength;
  Springs springs;
};

/// From K = k_i + k_j and S = r_i + r_j: 1/r* = K, 1/m* = mass_factor K^2 (K - 3/S), with one division.
PACKMPI_INLINE Reduced reduced_of_pair(double mass_factor, double curvature, double radius) {
  const double a = mass_factor * curvature * curvature * (curvature * radius - 3.0);
  const double b = 1.0 / (a * curvature);
  return {a * b, radius * curvature * b};
}

/// From k_i + k_j and w_i + w_j, w = 1/m: with one division, too.
PACKMPI_INLINE Reduced reduced_of_mixed(double curvature, double inverse_mass) {
  const double b = 1.0 / (curvature * inverse_mass);
  return {inverse_mass * b, curvature * b};
}

PACKMPI_INLINE Reduced reduced_of_wall(double mass_factor, double curvature, double radius) {
  return {radius, 1.0 / (mass_factor * curvature * curvature * curvature)};
}

/// Where two particles meet.
struct Touch {
  Vector normal;
  double bend;  // 1 / distance of the centres; 0 at a flat wall
  double gap;   // the overlap; negative: they do not touch
};

/// Where two centres are from each other: normal from the first to the second, distance and its inverse.
struct Separation {
  Vector normal;
  double distance, inverse;
};

/// Of centres (x, y, z) apart, whose square is given.
PACKMPI_INLINE Separation separation(double x, double y, double z, double square) {
  const double distance = root(square + tiny);
  const double inverse = 1.0 / distance;
  return {{x * inverse, y * inverse, z * inverse}, distance, inverse};
}

/// From the doubles in the order of scene::storings.
template <Features F>
PACKMPI_INLINE Springs springs_of(const double* x) {
  if constexpr (!F.memory) return {};
  if constexpr (F.dimension == 2) return {{x[0], 0.0, 0.0}, {F.rolling ? x[1] : 0.0, 0.0, 0.0}, 0.0};
  if constexpr (!F.rolling) return {{x[0], x[1], x[2]}, {}, 0.0};
  return {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}, x[6]};
}

/// What the springs of a contact share in a step.
struct SpringState {
  double contact;    // radius a of the contact area, sqrt(r* delta) [m]
  double stiffness;  // k = 8 G* a [N/m]
  double drag;       // k dt + eta: a spring that begins to move at u has grown by u dt and damps, too [N s/m]
  double kept;       // the smaller of the overlaps before and after the step [m]
  double overlap;
};

/// So small a drag stands for none [N s/m]: its quotients stay finite.
constexpr double tiny_drag = 1e-100;

/// `damped`: sqrt(m* a). `rate`: at which the overlap grows; `drift`: square of the centres' tangential velocity.
PACKMPI_INLINE SpringState spring_state(const Constants& c, const Meeting& at, double contact, double damped,
                                        double rate, double drift) {
  const double dt = c.time_step;
  // x(t) = x(t - dt) + v(t) dt: the overlap of the step before, to the third order of dt.
  const double before = at.overlap - dt * (rate + 0.5 * dt * at.bend * drift);
  const double positive = before < 0.0 ? 0.0 : before;
  const double stiffness = c.shear_stiffness * contact;
  return {contact, stiffness, stiffness * dt + c.shear_damping * damped, positive < at.overlap ? positive : at.overlap,
          at.overlap};
}

/// The part of an elastic displacement that is left after the contact has grown, when the force stays and the
/// displacement falls as 1/a, or shrunk, when the displacement stays and the force falls as a: a load cycle gives no
/// energy. The ratio of the radii is a root of that of the overlaps; in its place stands their harmonic mean over the
/// greater, which is the same to the second order of the step and never more. Exactly 1 at rest.
PACKMPI_INLINE double kept_part(const SpringState& now) { return 2.0 * now.kept / (now.overlap + now.kept + tiny); }

/// The same for a vector in the tangent plane, which is turned with the pair: projected on the new plane, and made as
/// long as it was, by a quotient that is the root's of 1 + tan^2 to its sixth order and never more.
PACKMPI_INLINE Vector turned(const SpringState& now, const Vector& n, const Vector& a) {
  const double off = dot(a, n);
  const Vector flat = sum(a, -off, n);
  const double square = 4.0 * dot(flat, flat);
  const double lost = off * off;
  const double longer = (square + 3.0 * lost) * (2.0 * now.kept);
  return scaled(longer / ((square + lost) * (now.overlap + now.kept) + tiny), flat);
}

/// A spring and its dashpot, in a row with a slider of the limit `most` [N]: the force for a displacement `x` (before
/// the step) that grows at `u`, unless it slides; x becomes that after the step.
PACKMPI_INLINE Vector pull(const SpringState& now, const Constants& c, double most, const Vector& u, Vector& x) {
  const Vector elastic = scaled(now.stiffness, x);
  const Vector trial = sum(elastic, now.drag, u);
  const double strength = root(dot(trial, trial) + tiny);
  const double drag = now.drag + tiny_drag;
  const double inverse = 1.0 / (strength * drag);  // of both, by one division
  const double part = most * (drag * inverse);
  const Vector force = scaled(part < 1.0 ? part : 1.0, trial);
  x = sum(x, c.time_step * (strength * inverse), sum(force, -1.0, elastic));
  return force;
}

/// The same for a displacement that is a number.
PACKMPI_INLINE double pull(const SpringState& now, const Constants& c, double most, double u, double& x) {
  const double elastic = now.stiffness * x;
  const double trial = elastic + now.drag * u;
  const double strength = magnitude(trial);
  const double force = with_sign_of(most < strength ? most : strength, trial);
  x = x + c.time_step / (now.drag + tiny_drag) * (force - elastic);
  return force;
}

/// A contact before friction is known: what the normal direction makes of it.
struct Pressed {
  Vector n;
  double normal;    // force [N]; its magnitude limits friction
  Vector u;         // tangential velocity of the second past the first where they touch [m/s]
  SpringState now;  // memory only
  double radius;    // reduced [m]
};

/// n from first to second, u = v_second - v_first, s = sum of r omega.
template <Features F>
PACKMPI_INLINE Pressed press_3d(const Constants& c, const Meeting& at) {
  const double rate = -dot(at.v, at.n);
  const double contact = root(at.reduced.radius * at.overlap);
  const double damped = root(at.reduced.mass * contact);
  const double raw = c.stiffness * contact * at.overlap + c.damping * damped * rate;
  Pressed p = {at.n, raw < c.lowest_force ? c.lowest_force : raw, {}, {}, at.reduced.radius};  // a NaN passes through
  if constexpr (F.friction) {
    const Vector across = sum(at.v, rate, at.n);
    p.u = {across.x, across.y, across.z};  // a copy of the whole is no statement that gcc vectorises
    if constexpr (F.rotation) p.u = sum(across, -c.spin_slip, cross(at.s, at.n));
    if constexpr (F.memory) p.now = spring_state(c, at, contact, damped, rate, dot(across, across));
  }
  return p;
}

/// Friction that remembers, and resistance to rolling and twisting.
template <Features F>
PACKMPI_INLINE Force hold_3d(const Constants& c, const Pressed& at, const Vector& spin, Springs springs) {
  const Vector n = at.n;
  const double strength = magnitude(at.normal);
  springs.slip = turned(at.now, n, springs.slip);
  const Vector t = pull(at.now, c, c.friction * strength, at.u, springs.slip);
  Vector torque = {};
  if constexpr (F.rolling) {
    const double about = dot(spin, n);
    springs.roll = turned(at.now, n, springs.roll);
    springs.twist = kept_part(at.now) * springs.twist;
    const Vector roll = scaled(at.radius, sum(spin, -about, n));
    const Vector r = pull(at.now, c, c.rolling_friction * strength, roll, springs.roll);
    const double w = pull(at.now, c, c.twisting_friction * strength, at.radius * about, springs.twist);
    torque = scaled(at.radius, sum(r, w, n));
  }
  return {sum(t, -at.normal, n), cross(n, t), torque, strength + 0.0 * dot(at.u, at.u), springs};
}

template <Features F>
PACKMPI_INLINE Force contact_3d(const Constants& c, const Meeting& at) {
  const Pressed p = press_3d<F>(c, at);
  const Vector n = p.n;
  const double strength = magnitude(p.normal);
  if constexpr (!F.friction) {
    return {{-(p.normal * n.x), -(p.normal * n.y), -(p.normal * n.z)}, {}, {}, strength, {}};
  } else if constexpr (F.memory) {
    return hold_3d<F>(c, p, at.spin, at.springs);
  } else {
    const double square = dot(p.u, p.u) + tiny;
    const double sliding = c.friction * strength / root(square);
    const double stopping = c.slip * at.reduced.mass;
    const Vector t = scaled(sliding < stopping ? sliding : stopping, p.u);
    return {sum(t, -p.normal, n), cross(n, t), {}, strength + 0.0 * square, {}};
  }
}

/// In the plane the tangent is (-n_y, n_x) and the slip a number along it: no root, no quotient.
template <Features F>
PACKMPI_INLINE Force contact_2d(const Constants& c, const Meeting& at) {
  const Vector n = at.n;
  const double rate = -(at.v.x * n.x + at.v.y * n.y);
  const double contact = root(at.reduced.radius * at.overlap);
  const double damped = root(at.reduced.mass * contact);
  const double raw = c.stiffness * contact * at.overlap + c.damping * damped * rate;
  const double normal = raw < c.lowest_force ? c.lowest_force : raw;
  const double strength = magnitude(normal);
  if constexpr (!F.friction) {
    return {{-(normal * n.x), -(normal * n.y), 0.0}, {}, {}, strength, {}};
  } else {
    double u = at.v.y * n.x - at.v.x * n.y;
    const double drift = u * u;
    if constexpr (F.rotation) u = u - c.spin_slip * at.s.z;
    Springs springs = at.springs;
    double t = 0.0;
    double torque = 0.0;
    if constexpr (F.memory) {
      const SpringState now = spring_state(c, at, contact, damped, rate, drift);
      const double part = kept_part(now);
      springs.slip.x = part * springs.slip.x;
      t = pull(now, c, c.friction * strength, u, springs.slip.x);
      if constexpr (F.rolling) {
        springs.roll.x = part * springs.roll.x;
        torque = at.reduced.radius *
                 pull(now, c, c.rolling_friction * strength, at.reduced.radius * at.spin.z, springs.roll.x);
      }
    } else {
      const double sliding = c.friction * strength;
      const double stopping = c.slip * at.reduced.mass * magnitude(u);
      t = with_sign_of(sliding < stopping ? sliding : stopping, u);
    }
    return {{-(t * n.y) - normal * n.x, t * n.x - normal * n.y, 0.0},
            {0.0, 0.0, t},
            {0.0, 0.0, torque},
            strength + 0.0 * u,
            springs};
  }
}

}  // namespace packmpi::dynamics::PACKMPI_KERNEL
