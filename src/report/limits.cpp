#include "report/limits.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "base/voids.hpp"

namespace packmpi::report {
namespace {

using Json = nlohmann::ordered_json;

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

Json to_object(const State& s) {
  return {{"friction_while_filling", s.friction},
          {"wall_friction_while_filling", s.wall_friction},
          {"rolling_friction_while_filling", s.rolling_friction},
          {"twisting_friction_while_filling", s.twisting_friction},
          {"phi_bulk", s.mean()},
          {"porosity_bulk", porosity(s.mean())},
          {"void_ratio_bulk", void_ratio(s.mean())},
          {"standard_error", s.error()},
          {"coordination", mean_of(s.coordinations)},
          {"phi_bulk_of_seed", s.fractions},
          {"coordination_of_seed", s.coordinations}};
}

std::string four_digits(double value) { return fmt::format("{:.4f}", value); }

}  // namespace

double State::mean() const { return mean_of(fractions); }

double State::error() const {
  if (fractions.size() < 2) return 0.0;
  const auto n = static_cast<double>(fractions.size());
  double squares = 0.0;
  for (const double value : fractions) squares += (value - mean()) * (value - mean());
  return std::sqrt(squares / (n - 1.0) / n);
}

std::string to_json(const LimitsReport& l) {
  Json root{{"format", "packmpi-limits"}, {"format_version", 1}, {"scene_file", l.scene_file}, {"seeds", l.seeds}};
  root["sample"] = {{"whole", l.whole}, {"particles", l.particles}, {"size", l.size}, {"scale", l.scale}};
  root["protocol"] = l.protocol;
  root["loosest"] = to_object(l.loosest);
  root["densest"] = to_object(l.densest);
  root["e_max"] = void_ratio(l.loosest.mean());
  root["e_min"] = void_ratio(l.densest.mean());
  root["units"] = {{"size", "m"}};
  return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string to_table(const LimitsReport& l) {
  fmt::memory_buffer out;
  const auto line = [&](std::string_view what, const std::string& loosest, const std::string& densest) {
    fmt::format_to(std::back_inserter(out), "  {:<44} {:>14} {:>14}\n", what, loosest, densest);
  };
  fmt::format_to(std::back_inserter(out), "{}\n{}\n", l.scene_file, l.protocol);
  line("", "loosest", "densest");
  const auto both = [&](std::string_view what, auto value) {
    line(what, fmt::format("{:.4g}", value(l.loosest)), fmt::format("{:.4g}", value(l.densest)));
  };
  both("friction while filling", [](const State& s) { return s.friction; });
  both("wall friction while filling", [](const State& s) { return s.wall_friction; });
  both("rolling friction while filling", [](const State& s) { return s.rolling_friction; });
  both("twisting friction while filling", [](const State& s) { return s.twisting_friction; });
  line("solid fraction of the bulk", four_digits(l.loosest.mean()), four_digits(l.densest.mean()));
  line("porosity", four_digits(porosity(l.loosest.mean())), four_digits(porosity(l.densest.mean())));
  line("void ratio, e_max and e_min", four_digits(void_ratio(l.loosest.mean())),
       four_digits(void_ratio(l.densest.mean())));
  both("standard error of the solid fraction", [](const State& s) { return s.error(); });
  both("coordination number", [](const State& s) { return mean_of(s.coordinations); });
  return fmt::to_string(out);
}

}  // namespace packmpi::report
