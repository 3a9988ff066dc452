/// NAME.analysis.json and the table on the screen.
#pragma once
#include <cstdint>
#include <string>

#include "observe/analysis.hpp"

namespace packmpi::report {

/// The analysis as JSON; a profile is {"from", "width", "values"} (doc/analyze.md). `pack_seal` tells which pack it is
/// of (pack::seal_of()). Local.
[[nodiscard]] std::string to_json(const observe::Analysis& analysis, int dimension, std::uint64_t pack_seal);
/// Its numbers as a table; profiles are left out. Local.
[[nodiscard]] std::string to_table(const observe::Analysis& analysis, int dimension);

}  // namespace packmpi::report
