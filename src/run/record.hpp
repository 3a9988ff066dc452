/// Filling the record of a run: what was asked, what came of it.
#pragma once
#include "report/record.hpp"
#include "run/pile.hpp"

namespace packmpi::run {

/// The asked half and the provenance. Local.
[[nodiscard]] report::RunRecord asked(const comm::Comm& comm, const scene::Scene& scene);

/// The got half with the final audit, of a pile whose lists are up to date. Collective.
void got(const Pile& pile, report::RunRecord& record);

}  // namespace packmpi::run
