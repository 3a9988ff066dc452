/// The record as JSON, and as a table on the screen.
#pragma once
#include <string>

#include "report/record.hpp"

namespace packmpi::report {

/// The record as JSON text (2-space indent, stable key order, 17 digits). Local.
[[nodiscard]] std::string to_json(const RunRecord& record);

/// "Target versus achieved" and the layers as a plain-text table of at most 100 columns. Local.
[[nodiscard]] std::string to_table(const RunRecord& record);

}  // namespace packmpi::report
