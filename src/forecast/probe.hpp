/// How fast this machine takes a scene.
#pragma once
#include "report/estimate.hpp"
#include "scene/scene.hpp"

namespace packmpi::forecast {

/// Makes a few layers of the scene on a smaller floor, in memory, for about `seconds` of wall time at most (insertion
/// beside), and times them. Of this rank alone: ranks that do it at the same time share the machine as they would in a
/// run. Throws Error(bad_input) where a layer cannot be inserted, as the run would; numerical_failure.
[[nodiscard]] report::Probe probe(const scene::Scene& scene, double seconds);

}  // namespace packmpi::forecast
