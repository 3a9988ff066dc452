/// `packmpi analyze`: what a pack is like inside.
#pragma once
#include <cstdint>
#include <string>

#include "comm/comm.hpp"
#include "scene/scene.hpp"

namespace packmpi::run {

/// Collective. Analyses the pack at `path` and writes NAME.analysis.json beside it, the same bytes on any number of
/// ranks; an older one is replaced. Returns the table for the screen. Throws Error(io_failure).
[[nodiscard]] std::string analyze(const comm::Comm& comm, const std::string& path);

/// Of a scene with output.analysis, whose measures reach 2.5 diameters and so want wider columns than the run, how many
/// ranks can be used, and whether so many can: throws Error(bad_input). Of others what the run can use. Local.
[[nodiscard]] std::int64_t most_ranks(const scene::Scene& scene);
void check_ranks(const scene::Scene& scene, int ranks);

}  // namespace packmpi::run
