/// `packmpi limits`: the loosest and the densest state of a scene.
#pragma once
#include <string>

#include "comm/comm.hpp"
#include "input/read.hpp"
#include "report/limits.hpp"

namespace packmpi::forecast {

/// Collective. Both states of the scene of that path, by run::find_extremes(); nothing is written. A scene without
/// [target] has the knobs of one. Throws Error(bad_input) for scenes that no target can be met with.
[[nodiscard]] report::LimitsReport limits(const comm::Comm& comm, const std::string& path,
                                          const input::Overrides& overrides);

}  // namespace packmpi::forecast
