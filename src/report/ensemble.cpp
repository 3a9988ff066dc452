#include "report/ensemble.hpp"

#include <fmt/format.h>

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "report/summary.hpp"

namespace packmpi::report {
namespace {

using Json = nlohmann::ordered_json;

// Label ("set 1", "all") and its statistics, a quantity each. One set is "all" at once.
struct Group {
  std::string label;
  std::vector<Statistics> of;
};

std::vector<Group> groups_of(const EnsembleTable& table) {
  std::map<int, std::vector<std::vector<double>>> sets;  // set -> quantity -> values
  const std::size_t quantities = ensemble_quantities.size();
  std::vector<std::vector<double>> all(quantities);
  for (const EnsembleRow& row : table.packs) {
    auto& set = sets.try_emplace(row.set, quantities).first->second;
    for (std::size_t q = 0; q < quantities; ++q) {
      set[q].push_back(row.values[q]);
      all[q].push_back(row.values[q]);
    }
  }
  std::vector<Group> groups;
  const auto add = [&](const std::string& label, const std::vector<std::vector<double>>& values) {
    Group group{label, {}};
    for (const std::vector<double>& v : values) group.of.push_back(statistics(v));
    groups.push_back(std::move(group));
  };
  if (sets.size() > 1) {
    for (const auto& [set, values] : sets) add(fmt::format("set {}", set), values);
  }
  add("all", all);
  return groups;
}

}  // namespace

EnsembleRow ensemble_row(int set, int pack, std::uint64_t seed, int code, const std::string& summary) {
  EnsembleRow row{.set = set, .pack = pack, .seed = seed, .code = code};
  row.values.fill(std::numeric_limits<double>::quiet_NaN());
  if (summary.empty()) return row;
  const Summary read = read_summary(summary);
  for (std::size_t q = 0; q < row.values.size(); ++q) {
    const auto found = read.achieved.find(ensemble_quantities[q]);
    if (found != read.achieved.end()) row.values[q] = found->second;
  }
  return row;
}

Statistics statistics(const std::vector<double>& values) {
  Statistics s;
  double sum = 0.0;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    ++s.count;
    sum += v;
  }
  if (s.count == 0) return s;
  s.mean = sum / s.count;
  if (s.count == 1) return s;
  double squares = 0.0;
  for (const double v : values) squares += std::isfinite(v) ? (v - s.mean) * (v - s.mean) : 0.0;
  s.sd = std::sqrt(squares / (s.count - 1));
  s.variation = s.mean != 0.0 ? s.sd / std::fabs(s.mean) : 0.0;
  const boost::math::students_t student(s.count - 1);
  s.confidence = boost::math::quantile(student, 0.975) * s.sd / std::sqrt(static_cast<double>(s.count));
  return s;
}

std::string to_csv(const EnsembleTable& table) {
  std::string out = "set,pack,seed,code";
  for (const char* quantity : ensemble_quantities) out += fmt::format(",{}", quantity);
  out += '\n';
  for (const EnsembleRow& row : table.packs) {
    out += fmt::format("{},{},{},{}", row.set, row.pack, row.seed, row.code);
    for (const double value : row.values)
      out += std::isfinite(value) ? fmt::format(",{:.17g}", value) : std::string(",");
    out += '\n';
  }
  return out;
}

std::string to_json(const EnsembleTable& table) {
  Json root{{"format", "packmpi-ensemble"}, {"format_version", 1}, {"name", table.name}};
  for (const EnsembleRow& row : table.packs) {
    Json pack{{"set", row.set}, {"pack", row.pack}, {"seed", row.seed}, {"code", row.code}};
    for (std::size_t q = 0; q < row.values.size(); ++q) pack[ensemble_quantities[q]] = row.values[q];
    root["packs"].push_back(std::move(pack));
  }
  for (const Group& group : groups_of(table)) {
    for (std::size_t q = 0; q < group.of.size(); ++q) {
      const Statistics& s = group.of[q];
      root["statistics"][group.label][ensemble_quantities[q]] = {{"count", s.count},
                                                                 {"mean", s.mean},
                                                                 {"sd", s.sd},
                                                                 {"coefficient_of_variation", s.variation},
                                                                 {"confidence_95", s.confidence}};
    }
  }
  return root.dump(2) + "\n";
}

std::string to_markdown(const EnsembleTable& table) {
  fmt::memory_buffer out;
  fmt::format_to(std::back_inserter(out),
                 "# {}\n\n| packs | n | quantity | mean | sd | coefficient of variation | 95 % confidence, +- |\n"
                 "|---|---|---|---|---|---|---|\n",
                 table.name);
  const auto cell = [](double x, int digits) { return std::isfinite(x) ? fmt::format("{:.{}g}", x, digits) : "-"; };
  for (const Group& group : groups_of(table)) {
    for (std::size_t q = 0; q < group.of.size(); ++q) {
      const Statistics& s = group.of[q];
      fmt::format_to(std::back_inserter(out), "| {} | {} | {} | {} | {} | {} | {} |\n", group.label, s.count,
                     ensemble_quantities[q], cell(s.mean, 6), cell(s.sd, 2), cell(s.variation, 2),
                     cell(s.confidence, 2));
    }
  }
  return fmt::to_string(out);
}

}  // namespace packmpi::report
