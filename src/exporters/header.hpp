/// What every file says at its head. Private to this module.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "handover/specimen.hpp"

namespace packmpi::exporters {

/// A line each, without marks of a comment: versions, seed, units, box, and what was trimmed or copied.
[[nodiscard]] std::vector<std::string> header_lines(const handover::Specimen& specimen);
/// The same as text, each line behind `mark`.
[[nodiscard]] std::string header(const handover::Specimen& specimen, std::string_view mark);

}  // namespace packmpi::exporters
