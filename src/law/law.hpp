/// The contact law's constants (CC16 eqs. 7-15; doc/theory.md has our readings), ready for the kernels.
#pragma once
#include <memory>
#include <vector>

#include "scene/scene.hpp"

namespace packmpi::dynamics {

/// Constants of one kind of contact: particle-particle or particle-wall.
struct LawConstants {
  double stiffness;       ///< 4/3 E* [Pa]; normal elastic force = stiffness * sqrt(r* delta) * delta
  double damping;         ///< 2 xi sqrt(2 E*): d* = damping * sqrt(m* sqrt(r* delta))
  double friction;        ///< mu_d [-]
  double reduced_radius;  ///< r* [m], equal radii only; graded contacts compute theirs
  double reduced_mass;    ///< m* [kg], equal radii only
  // Friction with memory only.
  double shear_stiffness = 0.0;    ///< 8 G* [Pa]: k_t = shear_stiffness * a, a = sqrt(r* delta)
  double shear_damping = 0.0;      ///< eta_t = shear_damping * sqrt(m* a): the damping ratio xi on k_t and m_t
  double rolling_friction = 0.0;   ///< mu_r [-]: the torque against rolling is at most mu_r |f_n| r*
  double twisting_friction = 0.0;  ///< mu_t [-]
};

/// What the whole scene's contacts share.
struct Law {
  LawConstants pair;    ///< with several components: the largest of all pairs, for bounds
  LawConstants wall;    ///< r* = r_i, m* = m_i; rigid: E* = E/(1 - nu^2); material: as a pair
  double mass_factor;   ///< 3 / (4 pi rho): 1/m = mass_factor * k^3, k = 1/r
  double spin_slip;     ///< 1: slip at the contact point includes spin; 0: centre velocities only (literal eq. 14)
  double slip_rate;     ///< 1/time_step ("stop"), a third of it ("shared"), 1/slip_time ("viscous"), or a huge number
                        ///< ("none") [1/s]
  double slip_mass;     ///< m_t / m*: 2/7 with rotation and contact velocities, else 1
  double lowest_force;  ///< 0 with the tension cut-off, else -infinity [N]
  // Several components only: by the code of a pair, and by that of a particle (scene/mixture.hpp). Owned by `tables`.
  const LawConstants* pair_table = nullptr;
  const LawConstants* wall_table = nullptr;
  std::shared_ptr<const std::vector<LawConstants>> tables = {};

  /// Of two particles whose codes add up to `code`, and of one at a wall. Without several components: `pair`, `wall`.
  [[nodiscard]] const LawConstants& of_pair(double code) const {
    return pair_table == nullptr ? pair : pair_table[static_cast<int>(code)];
  }
  [[nodiscard]] const LawConstants& of_wall(double code) const {
    return wall_table == nullptr ? wall : wall_table[static_cast<int>(code)];
  }
};

/// The law of a scene, for the time step and modulus of a stage.
[[nodiscard]] Law make_law(const scene::Scene& scene, const scene::Stage& stage);
/// The same for the scene's last stage.
[[nodiscard]] inline Law make_law(const scene::Scene& scene) { return make_law(scene, scene.last()); }

}  // namespace packmpi::dynamics
