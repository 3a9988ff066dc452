/// The contact law as Newton's method wants it: of any number type, so that derivatives come with the values, and with
/// friction that has no corner. Used by the implicit scheme only; the explicit kernels have their own.
#pragma once
#include <array>
#include <cmath>

#include "law/law.hpp"

namespace packmpi::dynamics {

template <class T>
using Triple = std::array<T, 3>;

template <class T>
[[nodiscard]] T dot(const Triple<T>& a, const Triple<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

template <class T>
[[nodiscard]] Triple<T> cross(const Triple<T>& a, const Triple<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// What a contact does: force on the first [N], n x f_t on both [N], and the normal force [N].
template <class T>
struct ContactForce {
  Triple<T> force, moment;
  T normal;
};

/// One contact. n: unit normal from first to second; overlap > 0 [m]; v = v_second - v_first [m/s]; s = sum of r omega
/// [m/s]; reduced radius [m] and mass [kg]. CC16 eqs. (7)-(11), and (12)-(15) with the friction force s u_t,
/// 1/s^2 = (|u_t| / mu f_n)^2 + (slip_time / m_t)^2: it tends to the two branches of the explicit law,
/// min(mu f_n / |u_t|, m_t / slip_time), and lies below both, by up to 0.71 where they cross.
template <class T>
[[nodiscard]] ContactForce<T> smooth_contact(const Law& law, const LawConstants& c, double reduced_radius,
                                             double reduced_mass, const Triple<T>& n, const T& overlap,
                                             const Triple<T>& v, const Triple<T>& s) {
  using std::sqrt;
  const T rate = -dot(v, n);
  const T contact = sqrt(reduced_radius * overlap);
  const T normal = c.stiffness * contact * overlap + c.damping * sqrt(reduced_mass * contact) * rate;
  ContactForce<T> f{{T(0.0), T(0.0), T(0.0)}, {T(0.0), T(0.0), T(0.0)}, T(0.0)};
  if (normal < law.lowest_force) return f;
  f.normal = normal;
  for (std::size_t a = 0; a < 3; ++a) f.force[a] = -(normal * n[a]);
  if (!(c.friction > 0.0) || normal == 0.0) return f;
  const Triple<T> lever = cross(s, n);
  Triple<T> u;
  for (std::size_t a = 0; a < 3; ++a) u[a] = v[a] + rate * n[a] - law.spin_slip * lever[a];
  const T sliding = c.friction * normal;  // negative where tension is allowed: its square counts
  const double stopping = law.slip_mass * law.slip_rate * reduced_mass;
  const T slope = stopping * sqrt(sliding * sliding / (stopping * stopping * dot(u, u) + sliding * sliding));
  Triple<T> t;
  for (std::size_t a = 0; a < 3; ++a) {
    t[a] = slope * u[a];
    f.force[a] = f.force[a] + t[a];
  }
  f.moment = cross(n, t);
  return f;
}

}  // namespace packmpi::dynamics
