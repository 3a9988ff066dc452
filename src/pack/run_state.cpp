#include "pack/run_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "base/error.hpp"

namespace packmpi::pack {
namespace {

using Json = nlohmann::ordered_json;

/// Calls visit(name, member) for every member of a layer's row. A member that is added to the row and not here does not
/// compile.
template <class Row, class Visit>
void each_member(Row& row, Visit visit) {
  auto& [inserted, total, attempts, target_fraction, achieved_fraction, region_bottom, height, top, duration, steps,
         kinetic_per_mgd, max_overlap, coordination, stop_reason] = row;
  visit("inserted", inserted);
  visit("total", total);
  visit("attempts", attempts);
  visit("target_fraction", target_fraction);
  visit("achieved_fraction", achieved_fraction);
  visit("region_bottom", region_bottom);
  visit("height", height);
  visit("top", top);
  visit("duration", duration);
  visit("steps", steps);
  visit("kinetic_per_mgd", kinetic_per_mgd);
  visit("max_overlap", max_overlap);
  visit("coordination", coordination);
  visit("stop_reason", stop_reason);
}

/// The same for the state's single values.
template <class State, class Visit>
void each_value(State& state, Visit visit) {
  visit("serial", state.serial);
  visit("version", state.version);
  visit("git", state.git);
  visit("dimension", state.dimension);
  visit("rotation", state.rotation);
  visit("first_ids", state.first_ids);
  visit("count", state.count);
  visit("energy_given", state.energy_given);
  visit("steps", state.steps);
  visit("particle_steps", state.particle_steps);
  visit("compaction_rate", state.compaction_rate);
  visit("moving_from", state.moving_from);
  visit("height", state.height);
  visit("relaxations", state.relaxations);
  visit("relaxation_steps", state.relaxation_steps);
  visit("height_before_relaxation", state.height_before_relaxation);
  visit("done", state.done);
  visit("phi_before", state.phi_before);
  visit("mean_height", state.mean_height);
  visit("calm_since", state.calm_since);
  visit("phi_calm", state.phi_calm);
}

constexpr std::array<std::string_view, 3> phase_names{"insertion", "settling", "relaxation"};

Phase phase_of(const std::string& name) {
  const auto found = std::ranges::find(phase_names, name);
  if (found == phase_names.end()) throw Error(ExitCode::bad_checkpoint, "/state names no phase of a run");
  return static_cast<Phase>(found - phase_names.begin());
}

Json row_to_json(const report::LayerRow& row) {
  Json object;
  each_member(row, [&](const char* name, const auto& value) { object[name] = value; });
  return object;
}

report::LayerRow row_of(const Json& object) {
  report::LayerRow row;
  each_member(row, [&](const char* name, auto& value) { object.at(name).get_to(value); });
  return row;
}

}  // namespace

std::string to_text(const RunState& state) {
  Json root;
  each_value(state, [&](const char* name, const auto& value) { root[name] = value; });
  root["phase"] = phase_names.at(static_cast<std::size_t>(state.phase));
  root["row"] = row_to_json(state.row);
  root["layers"] = Json::array();
  for (const report::LayerRow& row : state.layers) root["layers"].push_back(row_to_json(row));
  return root.dump(1);  // doubles: the shortest digits that give the same bits
}

RunState state_of(const std::string& text) {
  RunState state;
  try {
    const Json root = Json::parse(text);
    each_value(state, [&](const char* name, auto& value) { root.at(name).get_to(value); });
    state.phase = phase_of(root.at("phase").get<std::string>());
    state.row = row_of(root.at("row"));
    for (const Json& row : root.at("layers")) state.layers.push_back(row_of(row));
  } catch (const Json::exception& error) {
    throw Error(ExitCode::bad_checkpoint, fmt::format("/state is not what it should be: {}", error.what()));
  }
  if (to_text(state) != text) throw Error(ExitCode::bad_checkpoint, "/state is not what it should be: it says more");
  return state;
}

}  // namespace packmpi::pack
