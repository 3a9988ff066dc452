/// NAME.analysis.json and the table on the screen.
#pragma once
#include <string>

#include "observe/analysis.hpp"

namespace packmpi::report {

/// The analysis as JSON; a profile is {"from", "width", "values"} (doc/analyze.md). Local.
[[nodiscard]] std::string to_json(const observe::Analysis& analysis, int dimension);
/// Its numbers as a table; profiles are left out. Local.
[[nodiscard]] std::string to_table(const observe::Analysis& analysis, int dimension);

}  // namespace packmpi::report
