/// Is what a run made what the scene asked for? The one place where that is judged.
#pragma once
#include <string>
#include <vector>

#include "observe/rest.hpp"
#include "report/record.hpp"
#include "scene/scene.hpp"

namespace packmpi::report {

/// The measures of rest beside the scene's limits ([rest], doc/theory.md "Rest"). Those that the weight is the measure
/// of have no limit without gravity. Local.
[[nodiscard]] std::vector<Criterion> judge(const scene::Scene& scene, const observe::Rest& rest);

/// Do those hold that the final stage waits for: forces, energy and support? Overlaps do not come to rest. Local.
[[nodiscard]] bool at_rest(const std::vector<Criterion>& criteria);

/// What was missed of what the scene asked for, a sentence each: the measure, its value, its limit and what to change.
/// Empty: nothing. Needs the record whole. Local.
[[nodiscard]] std::vector<std::string> missed_targets(const scene::Scene& scene, const RunRecord& record);

/// Throws Error(numerical_failure) if the energy left at the end of a layer grows from layer to layer: of the newest
/// three, the least is over five times the most of the first three, and over 0.01 m g d and the scene's limit. Such a
/// bed never comes to rest. Looks at the layers from `first` on: what another run made has no energy of its own. Local,
/// on every rank alike.
void check_energy(const scene::Scene& scene, const std::vector<LayerRow>& layers, std::size_t first = 0);

}  // namespace packmpi::report
