/// `packmpi estimate`: what a scene will take, and the one of particles, height and floor that is left open.
#pragma once
#include <string>

#include "comm/comm.hpp"
#include "output/estimate.hpp"
#include "run/options.hpp"
#include "scene/scene.hpp"

namespace packmpi::run {

/// Collective. The scene of `options` with what options.question asks; nothing is written. Throws Error(bad_input) for
/// questions that have no answer or several, and for scenes that `check` would refuse.
[[nodiscard]] output::Estimate estimate(const comm::Comm& comm, const Options& options);

/// Sum over the layers of the particles that move while each settles, and over the final stage, times their steps.
/// Local, pure.
[[nodiscard]] std::int64_t particle_steps_of(const scene::Scene& scene, std::int64_t layers, std::int64_t a_layer);

}  // namespace packmpi::run
