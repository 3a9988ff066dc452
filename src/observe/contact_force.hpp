/// The force of one contact, with the formulas of the kernel written plainly (CC16 eqs. 7-15). Private to this module.
#pragma once
#include "dynamics/law.hpp"
#include "observe/touch.hpp"

namespace packmpi::observe {

/// Reduced radius and mass of a contact.
struct Reduced {
  double radius;  ///< [m]
  double mass;    ///< [kg]
};

/// Repulsive normal force [N] at an overlap [m] that grows at `rate` [m/s].
[[nodiscard]] double normal_force(const dynamics::Law& law, const dynamics::LawConstants& kind, const Reduced& reduced,
                                  double overlap, double rate);

/// Force [N] on i from its contact with j. Local.
[[nodiscard]] Vec3 pair_force(const particles::Store& store, const dynamics::Law& law, LocalIndex i, LocalIndex j,
                              const Touch& at);

/// Force [N] on i from a wall that it is `penetration` [m] deep in. Local.
[[nodiscard]] Vec3 wall_force(const particles::Store& store, const geometry::Container& box, const dynamics::Law& law,
                              LocalIndex i, neighbor::Wall wall, double penetration);

}  // namespace packmpi::observe
