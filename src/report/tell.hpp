/// The last lines of a run's log.
#pragma once
#include "comm/comm.hpp"
#include "report/record.hpp"
#include "scene/scene.hpp"

namespace packmpi::report {

/// Local. What the pack has come to: density, stress, sizes, rest; rank 0 warns of what was missed.
void tell(const comm::Comm& comm, const scene::Scene& scene, const RunRecord& record);

}  // namespace packmpi::report
