/// Filling the record of a run: what was asked, what came of it.
#pragma once
#include "report/record.hpp"
#include "run/bed.hpp"

namespace packmpi::run {

/// The asked half and the provenance. Local.
[[nodiscard]] report::RunRecord targets_of(const comm::Comm& comm, const scene::Scene& scene);

/// The got half with the final audit, of a bed whose lists are up to date. Collective.
void measure_bed(const Bed& bed, report::RunRecord& record);

}  // namespace packmpi::run
