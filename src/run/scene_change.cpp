#include "run/scene_change.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

namespace packmpi::run {
namespace {

/// key path -> value, of an effective input: a line "[table]" or "key = value" each.
std::map<std::string, std::string> values_of(const std::string& effective) {
  std::map<std::string, std::string> values;
  std::istringstream lines(effective);
  std::string table;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('[')) table = line.substr(1, line.find(']') - 1) + ".";
    const std::size_t equals = line.find(" = ");
    if (!line.starts_with('[') && equals != std::string::npos) {
      values[table + line.substr(0, equals)] = line.substr(equals + 3);
    }
  }
  return values;
}

bool may_change(std::string_view key) {
  constexpr std::array<std::string_view, 4> tables{"parallel.", "checkpoint.", "output.", "petsc."};
  return std::ranges::any_of(tables, [&](auto table) { return key.starts_with(table); });
}

}  // namespace

std::string forbidden_changes(const std::string& before, const std::string& now) {
  const auto old_values = values_of(before);
  const auto new_values = values_of(now);
  std::set<std::string> keys;
  for (const auto& [key, value] : old_values) keys.insert(key);
  for (const auto& [key, value] : new_values) keys.insert(key);
  const auto shown = [](const auto& values, const std::string& key) {
    const auto found = values.find(key);
    return found == values.end() ? std::string("absent") : found->second;
  };
  // More layers after the final stage are not the layers of a run that never had it.
  const std::string window = shown(new_values, "dynamics.window"),
                    relaxation = shown(new_values, "dynamics.relaxation");
  const bool final_stage = window != "0" || (relaxation != "\"auto\"" && relaxation != "0.0");
  std::string words;
  for (const std::string& key : keys) {
    const std::string was = shown(old_values, key), is = shown(new_values, key);
    if (was == is || may_change(key) || (key == "layers.maximum" && !final_stage)) continue;
    words += fmt::format("{}{}: {} before, {} now", words.empty() ? "" : "; ", key, was, is);
  }
  return words;
}

}  // namespace packmpi::run
