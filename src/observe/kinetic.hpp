/// Kinetic energy of one particle: the one place of its formula. Private to this module.
#pragma once
#include "particles/store.hpp"

namespace packmpi::observe {

/// Kinetic energy over the mass [m2/s2]. Discs are spheres, too: their moment of inertia is 2/5 m r^2.
struct Kinetic {
  double squared_speed;
  double spin;  ///< 1/5 (r omega)^2
  [[nodiscard]] double energy() const { return 0.5 * squared_speed + spin; }
};

/// Of an owned particle, whose record holds r omega.
[[nodiscard]] inline Kinetic kinetic_over_mass(const particles::Store& store, LocalIndex i) {
  const particles::Layout& layout = store.layout();
  const double* spin = store.record(i) + layout.spin;
  double squared_spin = 0.0;
  for (int c = 0; c < layout.spin_components(); ++c) squared_spin += spin[c] * spin[c];
  const Vec3 v = store.velocity(i);
  return {v[0] * v[0] + v[1] * v[1] + v[2] * v[2], 0.2 * squared_spin};
}

}  // namespace packmpi::observe
