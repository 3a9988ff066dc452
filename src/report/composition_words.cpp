#include "report/composition_words.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "report/report.hpp"

namespace packmpi::report {
namespace {

nlohmann::ordered_json known(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

}  // namespace

nlohmann::ordered_json composition_to_json(const observe::Composition& of, const std::vector<double>& wanted_masses) {
  using Object = nlohmann::ordered_json;
  Object root;
  root["components"] = Object::array();
  for (std::size_t k = 0; k < of.parts.size(); ++k) {
    const observe::ComponentPart& part = of.parts[k];
    Object one{{"name", part.name}, {"count", part.count}, {"volume", part.volume}, {"mass", part.mass}};
    if (k < wanted_masses.size()) one["target_mass"] = wanted_masses[k];
    one["lacey_index"] = known(part.lacey);
    one["lacey_error"] = known(part.lacey_error);
    root["components"].push_back(std::move(one));
  }
  root["lacey_cells"] = of.cells;
  root["lacey_cell_height"] = of.cell;
  root["boundaries"] = Object::array();
  for (const observe::StratumBoundary& at : of.boundaries) {
    Object one{{"below", at.below}, {"above", at.above}, {"height", at.height}, {"mixed_depth", at.mixed}};
    if (at.wanted > 0.0) one["target_height"] = at.wanted;
    root["boundaries"].push_back(std::move(one));
  }
  root["slab_height"] = of.slab;
  root["volume_shares"] = of.shares;
  return root;
}

std::vector<SizeLine> composition_lines(const observe::Composition& of, const std::vector<double>& wanted_masses) {
  std::vector<SizeLine> lines;
  for (std::size_t k = 0; k < of.parts.size(); ++k) {
    const observe::ComponentPart& part = of.parts[k];
    const std::string target = k < wanted_masses.size() ? fmt::format("{:.9g}", wanted_masses[k]) : "";
    lines.push_back({fmt::format("{}: particles", part.name), "", fmt::format("{}", part.count)});
    lines.push_back({fmt::format("{}: mass [kg]", part.name), target, fmt::format("{:.9g}", part.mass)});
    if (!std::isfinite(part.lacey)) continue;
    lines.push_back({fmt::format("{}: mixing, Lacey's index", part.name), "",
                     fmt::format("{:.4f} +- {:.4f}", part.lacey, part.lacey_error)});
  }
  for (const observe::StratumBoundary& at : of.boundaries) {
    lines.push_back({fmt::format("boundary of {} and {} [m]", at.below, at.above),
                     at.wanted > 0.0 ? fmt::format("{:.5g}", at.wanted) : "", fmt::format("{:.5g}", at.height)});
    lines.push_back({fmt::format("  depth of each beyond it [m]"), "", fmt::format("{:.3g}", at.mixed)});
  }
  return lines;
}

std::vector<std::string> composition_log(const RunRecord& record) {
  std::vector<std::string> lines;
  const observe::Composition& of = record.composition;
  for (std::size_t k = 0; k < of.parts.size(); ++k) {
    const observe::ComponentPart& part = of.parts[k];
    std::string line = fmt::format("component {}: {} particles, {:.6g} kg", part.name, part.count, part.mass);
    if (k < record.component_masses.size()) line += fmt::format(", asked for {:.6g} kg", record.component_masses[k]);
    if (std::isfinite(part.lacey)) {
      line += fmt::format("; mixing (Lacey's index, 1: by chance, 0: apart) {:.3f} +- {:.3f}", part.lacey,
                          part.lacey_error);
    }
    lines.push_back(std::move(line));
  }
  for (const observe::StratumBoundary& at : of.boundaries) {
    std::string line = fmt::format("strata {} and {} meet at {:.5g} m", at.below, at.above, at.height);
    if (at.wanted > 0.0) line += fmt::format(", asked for at {:.5g} m", at.wanted);
    lines.push_back(line + fmt::format("; {:.2g} m deep of each lies beyond it", at.mixed));
  }
  return lines;
}

}  // namespace packmpi::report
