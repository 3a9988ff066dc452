#include "pack/scene_change.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

#include "base/digest.hpp"
#include "base/error.hpp"
#include "config/words.hpp"
#include "input/read.hpp"
#include "packmpi/version.hpp"

namespace packmpi::pack {
namespace {

/// key path -> value, of an effective input: a line "[table]" or "key = value" each. Tables of an array, "[[table]]",
/// are numbered from 1.
std::map<std::string, std::string> values_of(const std::string& effective) {
  std::map<std::string, std::string> values;
  std::istringstream lines(effective);
  std::string table, array;
  std::map<std::string, int> numbers;
  const auto named = [&](const std::string& name) {
    const bool within = !array.empty() && name.starts_with(array + ".");
    return within ? fmt::format("{}[{}]{}.", array, numbers[array], name.substr(array.size())) : name + ".";
  };
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("[[")) {
      array = line.substr(2, line.find(']') - 2);
      table = fmt::format("{}[{}].", array, ++numbers[array]);
    } else if (line.starts_with('[')) {
      table = named(line.substr(1, line.find(']') - 1));
    }
    const std::size_t equals = line.find(" = ");
    if (!line.starts_with('[') && equals != std::string::npos) {
      values[table + line.substr(0, equals)] = line.substr(equals + 3);
    }
  }
  return values;
}

bool may_change(std::string_view key, RunIs run) {
  if (run == RunIs::finished && key == "output.contacts") return false;
  constexpr std::array<std::string_view, 4> tables{"parallel.", "checkpoint.", "output.", "petsc."};
  return std::ranges::any_of(tables, [&](auto table) { return key.starts_with(table); });
}

}  // namespace

std::string forbidden_changes(const std::string& before, const std::string& now, RunIs run) {
  const auto old_values = values_of(before);
  const auto new_values = values_of(now);
  std::set<std::string> keys;
  for (const auto& [key, value] : old_values) keys.insert(key);
  for (const auto& [key, value] : new_values) keys.insert(key);
  const auto shown = [](const auto& values, const std::string& key) {
    const auto found = values.find(key);
    if (found == values.end()) return std::string("absent");
    if (key != "container.surface") return found->second;
    return fmt::format("a mesh of {} bytes with digest {:016x}", found->second.size(),
                       fnv_add(fnv_start, found->second));
  };
  // More layers after the final stage are not the layers of a run that never had it.
  const std::string window = shown(new_values, "dynamics.window"),
                    relaxation = shown(new_values, "dynamics.relaxation");
  const bool fixed = run == RunIs::finished || window != "0" || (relaxation != "\"auto\"" && relaxation != "0.0");
  std::string words;
  for (const std::string& key : keys) {
    const std::string was = shown(old_values, key), is = shown(new_values, key);
    if (was == is || may_change(key, run) || (key == "layers.maximum" && !fixed)) continue;
    words += fmt::format("{}{}: {} before, {} now", words.empty() ? "" : "; ", key, was, is);
  }
  return words;
}

std::string container_change(const input::Container& before, const input::Container& now) {
  if (now.dimension != before.dimension) {
    return fmt::format("a container in {}D, the scene in one in {}D", before.dimension, now.dimension);
  }
  if (now.shape != before.shape) {
    return fmt::format("a container of the shape \"{}\", the scene in one of the shape \"{}\"; give that of the pack",
                       input::word(before.shape), input::word(now.shape));
  }
  if (now.surface != before.surface) return "a mesh of another surface than the scene's; give that of the pack";
  const bool wall = now.bottom_diameter == before.bottom_diameter && now.top_diameter == before.top_diameter &&
                    now.inner_diameter == before.inner_diameter && now.bottom_width == before.bottom_width &&
                    now.top_width == before.top_width && now.polygon == before.polygon;
  const bool slopes = now.shape == input::VesselShape::frustum || now.shape == input::VesselShape::trapezium;
  const bool slope = !slopes || now.size.back() == before.size.back();
  if (!wall || !slope) return "a vessel of other lengths or another height than the scene's; give those of the pack";
  for (std::size_t axis = 0; axis + 1 < now.size.size(); ++axis) {
    if (now.size[axis] == before.size[axis] && now.boundary[axis] == before.boundary[axis]) continue;
    return fmt::format(
        "a container of {:g} m along {} with boundary \"{}\", the scene in one of {:g} m with \"{}\"; "
        "give that of the pack",
        before.size[axis], "xy"[axis], input::word(before.boundary[axis]), now.size[axis],
        input::word(now.boundary[axis]));
  }
  return "";
}

bool is_this_program(const Writer& writer) { return writer.version == version() && writer.git == git_id(); }

std::string changes_since(const Writer& writer, const std::string& now, RunIs run, const std::string& what) {
  if (is_this_program(writer)) return forbidden_changes(writer.scene, now, run);
  try {
    return forbidden_changes(input::parse(writer.scene, "the scene in it", {}).effective, now, run);
  } catch (const Error& error) {
    throw Error(ExitCode::bad_checkpoint,
                fmt::format("{}: {}; go on with the packmpi that wrote it, or begin anew with --force and without "
                            "--restart",
                            what, error.what()));
  }
}

}  // namespace packmpi::pack
