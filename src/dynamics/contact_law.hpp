/// The contact law for one contact at a time: the very function of the step kernels, for those who look at forces.
#pragma once
#include <cstdint>

#include "dynamics/law.hpp"
#include "neighbor/neighborhood.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::dynamics {

/// What the contacts of a list have stored: double c of entry p at values[c * entries + p]. Null: nothing.
struct StoredView {
  const double* values = nullptr;
  std::int64_t entries = 0;
};

[[nodiscard]] inline StoredView stored_pairs(const neighbor::Neighborhood& neighborhood) {
  return {neighborhood.memory().of_pairs(), std::ssize(neighborhood.pairs().first)};
}
[[nodiscard]] inline StoredView stored_walls(const neighbor::Neighborhood& neighborhood) {
  return {neighborhood.memory().of_walls(), std::ssize(neighborhood.walls().particle)};
}

/// The displacements of a contact's springs [m], in the plane of now, oriented from the first end to the second: the
/// tangential one, that of rolling along the axis about which the second turns, and the angle of twisting times r*.
struct SpringDisplacements {
  Vec3 tangential{}, rolling{};
  double twisting = 0.0;
};

/// What a contact does now.
struct ContactEffect {
  Vec3 force{};                ///< [N] on the first: normal, friction and the dashpots'
  Vec3 torque{};               ///< [N m] on the first, of rolling and twisting resistance; its negative on the second
  double normal = 0.0;         ///< [N] magnitude of the normal force before its sign
  double spring_energy = 0.0;  ///< [J] in the tangential, rolling and twisting springs
  SpringDisplacements springs{};
};

/// Of two particles that touch or not (then all is zero, but for what a law does without overlap). `entry` of `stored`
/// is theirs, oriented from i to j. The springs are taken as they are, turned into the plane of now. Local.
[[nodiscard]] ContactEffect pair_contact(const scene::Scene& scene, const Law& law, const particles::Store& store,
                                         LocalIndex i, LocalIndex j, const StoredView& stored = {},
                                         std::int64_t entry = 0);
/// Of a particle and what is there of a wall.
[[nodiscard]] ContactEffect wall_contact(const scene::Scene& scene, const Law& law, const particles::Store& store,
                                         LocalIndex i, const geometry::Facing& wall, const StoredView& stored = {},
                                         std::int64_t entry = 0);
/// Not of a mesh.
[[nodiscard]] ContactEffect wall_contact(const scene::Scene& scene, const Law& law, const particles::Store& store,
                                         LocalIndex i, neighbor::Wall wall, const StoredView& stored = {},
                                         std::int64_t entry = 0);

/// [J] The spring_energy of the above alone, bit for bit, at a fraction of the cost: a row of the step log asks for
/// that of every contact. 0 without memory. Local.
[[nodiscard]] double pair_spring_energy(const scene::Scene& scene, const Law& law, const particles::Store& store,
                                        LocalIndex i, LocalIndex j, const StoredView& stored, std::int64_t entry);
[[nodiscard]] double wall_spring_energy(const scene::Scene& scene, const Law& law, const particles::Store& store,
                                        LocalIndex i, const geometry::Facing& wall, const StoredView& stored,
                                        std::int64_t entry);

}  // namespace packmpi::dynamics
