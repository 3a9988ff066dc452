/// What a bed of several components is made of, in words and as JSON. Private to this module.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "report/record.hpp"
#include "report/size_words.hpp"

namespace packmpi::report {

/// SI units; null where a number is not known.
[[nodiscard]] nlohmann::ordered_json composition_to_json(const observe::Composition& composition,
                                                         const std::vector<double>& wanted_masses);
/// Rows of the comparison; none without components.
[[nodiscard]] std::vector<SizeLine> composition_lines(const observe::Composition& composition,
                                                      const std::vector<double>& wanted_masses);

}  // namespace packmpi::report
