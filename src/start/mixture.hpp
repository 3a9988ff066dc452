/// Components of particles that are taken over.
#pragma once
#include <vector>

#include "comm/comm.hpp"
#include "control/mixing.hpp"
#include "input/input.hpp"
#include "pack/pack.hpp"
#include "scene/scene.hpp"

namespace packmpi::start {

/// Throws Error(bad_input) if the scene has several components, of which a text file says nothing. Local.
void check_one_material(const scene::Scene& scene);
/// Throws Error(bad_input) unless a pack of the scene `made` has the scene's components, by name and in their order.
/// Local.
void check_components(const scene::Scene& scene, const input::Input& made);

/// How far a bed has come that has the particles of a pack, its layers beginning with `first_ids`: what each component
/// adds up to is what was asked of it. Collective. Throws Error(bad_input) if ids of a layer do not ascend with the
/// components.
[[nodiscard]] control::Mixing mixing_of(const comm::Comm& comm, const scene::Scene& scene, const pack::PackRows& rows,
                                        const std::vector<GlobalId>& first_ids);

}  // namespace packmpi::start
