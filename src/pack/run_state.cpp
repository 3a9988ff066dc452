#include "pack/run_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "base/error.hpp"

namespace packmpi::pack {
namespace {

using Json = nlohmann::ordered_json;

// each_field(struct, visit) calls visit(name, field) for every field, for reading and for writing. A field that is
// added to a struct and not here does not compile: the structured bindings count them.

template <class Row, class Visit>
requires std::is_same_v<std::remove_const_t<Row>, report::LayerRow>
void each_field(Row& row, Visit visit) {
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

template <class Mark, class Visit>
requires std::is_same_v<std::remove_const_t<Mark>, report::SeriesMark>
void each_field(Mark& mark, Visit visit) {
  auto& [rows, in_file, digest] = mark;
  visit("rows", rows);
  visit("in_file", in_file);
  visit("digest", digest);
}

template <class F, class Visit>
requires std::is_same_v<std::remove_const_t<F>, control::Filling>
void each_field(F& filling, Visit visit) {
  auto& [on, target, knob, bias, knobs, filled, relaxed, slab_excess, layer_knobs, layer_surfaces, layer_fractions] =
      filling;
  visit("on", on);
  visit("target", target);
  visit("knob", knob);
  visit("bias", bias);
  visit("knobs", knobs);
  visit("filled", filled);
  visit("relaxed", relaxed);
  visit("slab_excess", slab_excess);
  visit("layer_knobs", layer_knobs);
  visit("layer_surfaces", layer_surfaces);
  visit("layer_fractions", layer_fractions);
}

template <class C, class Visit>
requires std::is_same_v<std::remove_const_t<C>, confine::State>
void each_field(C& confined, Visit visit) {
  auto& [on, from, lid, lid_speed, size, speed, steps, phi_before, full, work, over] = confined;
  visit("on", on);
  visit("from", from);
  visit("lid", lid);
  visit("lid_speed", lid_speed);
  visit("size", size);
  visit("speed", speed);
  visit("steps", steps);
  visit("phi_before", phi_before);
  visit("full", full);
  visit("work", work);
  visit("over", over);
}

template <class M, class Visit>
requires std::is_same_v<std::remove_const_t<M>, control::Mixing>
void each_field(M& mixing, Visit visit) {
  auto& [on, counts, drawn, units, wanted, extent, stratum, stratum_extent, stratum_layers, strata] = mixing;
  visit("on", on);
  visit("counts", counts);
  visit("drawn", drawn);
  visit("units", units);
  visit("wanted", wanted);
  visit("extent", extent);
  visit("stratum", stratum);
  visit("stratum_extent", stratum_extent);
  visit("stratum_layers", stratum_layers);
  visit("strata", strata);
}

template <class S, class Visit>
requires std::is_same_v<std::remove_const_t<S>, Swing>
void each_field(S& swing, Visit visit) {
  auto& [on, kinetic_energy] = swing;
  visit("on", on);
  visit("kinetic_energy", kinetic_energy);
}

template <class Now, class Visit>
requires std::is_same_v<std::remove_const_t<Now>, PhaseProgress>
void each_field(Now& now, Visit visit) {
  auto& [phase, row, done, phi_before, mean_height, calm_since, phi_calm, told, swing] = now;
  visit("phase", phase);
  visit("row", row);
  visit("done", done);
  visit("phi_before", phi_before);
  visit("mean_height", mean_height);
  visit("calm_since", calm_since);
  visit("phi_calm", phi_calm);
  visit("told", told);
  visit("swing", swing);
}

// The present phase's fields stand among the others.
template <class P, class Visit>
requires std::is_same_v<std::remove_const_t<P>, Progress>
void each_field(P& progress, Visit visit) {
  auto& [first_ids, count, moving_from, energy_given, steps, relaxation_steps, particle_steps, layers, height,
         compaction_rate, relaxations, height_before_relaxation, series, filling, confined, mixing, now] = progress;
  visit("first_ids", first_ids);
  visit("count", count);
  visit("moving_from", moving_from);
  visit("energy_given", energy_given);
  visit("steps", steps);
  visit("relaxation_steps", relaxation_steps);
  visit("particle_steps", particle_steps);
  visit("layers", layers);
  visit("height", height);
  visit("compaction_rate", compaction_rate);
  visit("relaxations", relaxations);
  visit("height_before_relaxation", height_before_relaxation);
  visit("series", series);
  visit("filling", filling);
  visit("confined", confined);
  visit("mixing", mixing);
  each_field(now, visit);
}

// The scene is a dataset of its own.
template <class State, class Visit>
requires std::is_same_v<std::remove_const_t<State>, RunState>
void each_field(State& state, Visit visit) {
  auto& [serial, effective_input, version, git, dimension, rotation, progress] = state;
  visit("serial", serial);
  visit("version", version);
  visit("git", git);
  visit("dimension", dimension);
  visit("rotation", rotation);
  each_field(progress, visit);
}

template <class T>
constexpr bool is_struct = std::is_same_v<T, report::LayerRow> || std::is_same_v<T, report::SeriesMark> ||
                           std::is_same_v<T, control::Filling> || std::is_same_v<T, confine::State> ||
                           std::is_same_v<T, control::Mixing> || std::is_same_v<T, Swing>;

constexpr std::array<std::string_view, 3> phase_names{"insertion", "settling", "relaxation"};

Phase phase_of(const std::string& name) {
  const auto found = std::ranges::find(phase_names, name);
  if (found == phase_names.end()) throw Error(ExitCode::bad_checkpoint, "/state names no phase of a run");
  return static_cast<Phase>(found - phase_names.begin());
}

// What a scene does not use is not there.
template <class T>
bool is_off(const T& value) {
  if constexpr (std::is_same_v<T, control::Filling> || std::is_same_v<T, confine::State> ||
                std::is_same_v<T, control::Mixing> || std::is_same_v<T, Swing>)
    return !value.on;
  return false;
}

template <class T>
Json json_of(const T& value) {
  if constexpr (std::is_same_v<T, Phase>) {
    return std::string(phase_names.at(static_cast<std::size_t>(value)));
  } else if constexpr (std::is_same_v<T, std::vector<report::LayerRow>>) {
    Json rows = Json::array();
    for (const report::LayerRow& row : value) rows.push_back(json_of(row));
    return rows;
  } else if constexpr (is_struct<T>) {
    Json object;
    each_field(value, [&](const char* name, const auto& field) { object[name] = json_of(field); });
    return object;
  } else {
    return value;
  }
}

template <class T>
void read(const Json& json, T& value) {
  if constexpr (std::is_same_v<T, Phase>) {
    value = phase_of(json.get<std::string>());
  } else if constexpr (std::is_same_v<T, std::vector<report::LayerRow>>) {
    for (const Json& row : json) read(row, value.emplace_back());
  } else if constexpr (is_struct<T>) {
    each_field(value, [&](const char* name, auto& field) { read(json.at(name), field); });
  } else {
    json.get_to(value);
  }
}

// Fields that are not there keep what they have, if they `may` be absent.
RunState parse_state(const std::string& text, bool may, RunState state) {
  try {
    const Json root = Json::parse(text);
    each_field(state, [&](const char* name, auto& field) {
      if ((!may && !is_off(field)) || root.contains(name)) read(root.at(name), field);
    });
  } catch (const Json::exception& error) {
    throw Error(ExitCode::bad_checkpoint, fmt::format("/state is not what it should be: {}", error.what()));
  }
  return state;
}

}  // namespace

std::string to_text(const RunState& state) {
  Json root;
  each_field(state, [&](const char* name, const auto& field) {
    if (!is_off(field)) root[name] = json_of(field);
  });
  return root.dump(1);  // doubles: the shortest digits that give the same bits
}

RunState state_of(const std::string& text) {
  RunState state = parse_state(text, false, {});
  if (to_text(state) != text) throw Error(ExitCode::bad_checkpoint, "/state is not what it should be: it says more");
  return state;
}

RunState former_state_of(const std::string& text) {
  RunState unknown;
  unknown.progress.series.in_file = -1;
  return parse_state(text, true, unknown);
}

}  // namespace packmpi::pack
