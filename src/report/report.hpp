/// The record as JSON, as a table, and in a few lines.
#pragma once
#include <string>
#include <vector>

#include "report/record.hpp"

namespace packmpi::report {

/// The record as JSON text (2-space indent, stable key order, 17 digits). Local.
[[nodiscard]] std::string to_json(const RunRecord& record);

/// What there is of each component, and where strata meet, a line each; none with one component. Local.
[[nodiscard]] std::vector<std::string> composition_log(const RunRecord& record);

/// "Target versus achieved" and the layers as a plain-text table of at most 100 columns. Local.
[[nodiscard]] std::string to_table(const RunRecord& record);

/// What a user looks for, in about ten lines, and `files`, the pack first. Lengths in a unit that suits them. Local.
[[nodiscard]] std::string to_lines(const RunRecord& record, const std::vector<std::string>& files);

}  // namespace packmpi::report
