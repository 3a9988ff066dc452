/// Bounds that follow from a scene: how fast its particles can be, how hard they can meet, how many layers it takes.
#pragma once
#include <cstdint>

#include "scene/scene.hpp"

namespace packmpi::scene {

/// Every layer adds phi_0 h_0 of solid and no bed is denser than solid: more layers than this never come to H_d, nor
/// more of those that end there. For a
/// number of particles, half as much again as they have in the mean; one, where insertion is all there is.
[[nodiscard]] std::int64_t most_layers(const Scene& scene);

/// What no particle of a valid run comes near [m/s]: 16 times what falls, inserted speeds, fluid and near field can
/// give together (doc/theory.md, "Guards").
[[nodiscard]] double speed_bound(const Scene& scene);

/// The unit in which forces are summed [N], a power of two. Throws Error(bad_input) where the largest force and the
/// weight of the smallest particle are too far apart for one unit.
[[nodiscard]] double force_quantum(const Scene& scene);

}  // namespace packmpi::scene
