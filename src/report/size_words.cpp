#include "report/size_words.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace packmpi::report {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const observe::SizePoints& p) {
  return {{"d10", p.d10}, {"d30", p.d30},         {"d50", p.d50},       {"d60", p.d60},
          {"d90", p.d90}, {"cu", p.uniformity()}, {"cc", p.curvature()}};
}

Json to_json(const observe::SizeMatch& match) {
  return {{"target", to_json(match.target)}, {"achieved", to_json(match.achieved)}, {"distance", match.distance}};
}

void add_lines(const char* weighting, const observe::SizeMatch& match, std::vector<SizeLine>& lines) {
  const auto line = [&](const char* what, double target, double achieved) {
    lines.push_back(
        {fmt::format(fmt::runtime(what), weighting), fmt::format("{:.5g}", target), fmt::format("{:.5g}", achieved)});
  };
  line("D10 by {} [m]", match.target.d10, match.achieved.d10);
  line("D30 by {} [m]", match.target.d30, match.achieved.d30);
  line("D50 by {} [m]", match.target.d50, match.achieved.d50);
  line("D60 by {} [m]", match.target.d60, match.achieved.d60);
  line("D90 by {} [m]", match.target.d90, match.achieved.d90);
  line("Cu by {}", match.target.uniformity(), match.achieved.uniformity());
  line("Cc by {}", match.target.curvature(), match.achieved.curvature());
  lines.push_back({fmt::format("distance of the curves by {}", weighting), "0", fmt::format("{:.3g}", match.distance)});
}

}  // namespace

Json to_json(const observe::SizeMatches& sizes) {
  return {{"number", to_json(sizes.by_number)}, {"mass", to_json(sizes.by_mass)}};
}

std::vector<SizeLine> size_lines(const observe::SizeMatches& sizes) {
  std::vector<SizeLine> lines;
  add_lines("number", sizes.by_number, lines);
  add_lines("mass", sizes.by_mass, lines);
  return lines;
}

}  // namespace packmpi::report
