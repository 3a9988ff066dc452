/// The forces between particles, and at walls, of the implicit scheme: one by one, in any number type.
#pragma once
#include <optional>

#include "implicit/smooth_contact.hpp"
#include "neighbor/lists.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::dynamics {

/// One interaction as the law sees it: two ends, or one end and a wall at rest.
struct Interaction {
  LocalIndex first;
  LocalIndex second;      ///< -1: a wall
  Vec3 d;                 ///< [m] second - first, the nearest image; of a wall: to the foot of the perpendicular
  Vec3 v;                 ///< [m/s] second - first
  Vec3 s;                 ///< [m/s] sum of r omega
  Vec3 wall_normal;       ///< towards the wall
  double radii;           ///< [m] sum
  double reduced_radius;  ///< [m]
  double reduced_mass;    ///< [kg]
};

/// Of two particles.
[[nodiscard]] Interaction of_pair(const scene::Scene& scene, const Law& law, const particles::Store& store,
                                  LocalIndex i, LocalIndex j);
/// Of a particle and a wall.
[[nodiscard]] Interaction of_wall(const Law& law, const particles::Store& store, LocalIndex i,
                                  const geometry::Facing& at_wall);
/// 1/m [1/kg].
[[nodiscard]] double inverse_mass(const Law& law, const particles::Store& store, LocalIndex i);

/// Force of a contact, none without overlap. d, v, s as those of `at`, with derivatives if T has them.
template <class T>
[[nodiscard]] std::optional<ContactForce<T>> contact_force(const Law& law, const Interaction& at, const Triple<T>& d,
                                                           const Triple<T>& v, const Triple<T>& s) {
  using std::sqrt;
  const bool wall = at.second < 0;
  Triple<T> n;
  T distance;
  if (wall) {
    for (std::size_t a = 0; a < 3; ++a) n[a] = T(at.wall_normal[a]);
    distance = dot(d, n);
  } else {
    distance = sqrt(dot(d, d));
    for (std::size_t a = 0; a < 3; ++a) n[a] = d[a] / distance;
  }
  const T overlap = at.radii - distance;
  if (!(overlap > 0.0)) return std::nullopt;
  return smooth_contact<T>(law, wall ? law.wall : law.pair, at.reduced_radius, at.reduced_mass, n, overlap, v, s);
}

/// Near-field force of a pair (CC16 eqs. 5, 6), none beyond the cut-off.
template <class T>
[[nodiscard]] std::optional<ContactForce<T>> near_force(const input::NearField& law, const Triple<T>& d) {
  using std::pow;
  using std::sqrt;
  const T distance = sqrt(dot(d, d));
  if (!(distance < law.cutoff)) return std::nullopt;
  const T force = law.alpha1 * pow(distance, -law.beta1) - law.alpha2 * pow(distance, -law.beta2);
  ContactForce<T> f{{T(0.0), T(0.0), T(0.0)}, {T(0.0), T(0.0), T(0.0)}, T(0.0)};
  for (std::size_t a = 0; a < 3; ++a) f.force[a] = force * d[a] / distance;
  return f;
}

}  // namespace packmpi::dynamics
