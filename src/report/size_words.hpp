/// Target and achieved sizes, as JSON and as lines of a table. Private to this module.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "observe/size_match.hpp"

namespace packmpi::report {

/// {"number": {"target": {"d10", ..., "cu", "cc"}, "achieved": the same, "distance"}, "mass": the same}. Local.
[[nodiscard]] nlohmann::ordered_json to_json(const observe::SizeMatches& sizes);

/// One line of "target versus achieved".
struct SizeLine {
  std::string quantity, target, achieved;
};
/// D10 to D90, Cu, Cc and the distance, by number, then by mass. Local.
[[nodiscard]] std::vector<SizeLine> size_lines(const observe::SizeMatches& sizes);

}  // namespace packmpi::report
