#include "report/fields.hpp"

#include <utility>

#include "base/voids.hpp"

namespace packmpi::report {
namespace {

template <class Member>
std::vector<Member> collect(const std::vector<LayerRow>& layers, Member LayerRow::*member) {
  std::vector<Member> values;
  values.reserve(layers.size());
  for (const LayerRow& row : layers) values.push_back(row.*member);
  return values;
}

std::vector<double> lengths(const RunRecord& r) { return {r.size.begin(), r.size.begin() + r.dimension}; }

}  // namespace

std::vector<disk::Field> target_fields(const RunRecord& r) {
  std::vector<disk::Field> fields{{"name", "", r.name},
                                  {"dimension", "", std::int64_t{r.dimension}},
                                  {"size", "m", lengths(r)},
                                  {"target_height", "m", r.target_height},
                                  {"target_fraction", "-", r.target_fraction},
                                  {"target_mean_radius", "m", r.target_mean_radius},
                                  {"target_sd_radius", "m", r.target_sd_radius},
                                  {"target_min_radius", "m", r.target_min_radius},
                                  {"target_max_radius", "m", r.target_max_radius}};
  if (r.shape != "box") fields.push_back({"shape", "", r.shape});
  if (r.bottom_diameter > 0.0) fields.push_back({"bottom_diameter", "m", r.bottom_diameter});
  if (r.top_diameter > 0.0) fields.push_back({"top_diameter", "m", r.top_diameter});
  if (r.bottom_width > 0.0) fields.push_back({"bottom_width", "m", r.bottom_width});
  if (r.top_width > 0.0) fields.push_back({"top_width", "m", r.top_width});
  if (r.inner_diameter > 0.0) fields.push_back({"inner_diameter", "m", r.inner_diameter});
  if (r.target_particles > 0) fields.push_back({"target_particles", "", r.target_particles});
  if (r.density.on()) {
    fields.push_back({"target_density_key", "", r.density.key});
    fields.push_back({"target_phi_bulk", "-", r.density.fraction});
    fields.push_back({"target_tolerance", "-", r.density.tolerance});
    fields.push_back({"target_state", "", std::string(r.density.confined ? "confined" : "filled")});
  }
  if (r.confined.on) {
    fields.push_back({"target_vertical_stress", "Pa", r.confined.vertical});
    if (r.confined.lateral > 0.0) fields.push_back({"target_lateral_stress", "Pa", r.confined.lateral});
    fields.push_back({"target_stress_tolerance", "-", r.confined.tolerance});
  }
  return fields;
}

std::vector<disk::Field> confined_fields(const confine::Outcome& c) {
  if (!c.on) return {};
  return {{"lid", "m", c.lid},
          {"length_under_lid_x", "m", c.size.front()},
          {"length_under_lid_y", "m", c.size.size() > 1 ? c.size[1] : 0.0},
          {"stress_on_lid", "Pa", c.on_lid},
          {"stress_on_floor", "Pa", c.on_floor},
          {"stress_on_sides", "Pa", c.on_sides},
          {"stress_of_contacts", "Pa", c.of_contacts},
          {"vertical_stress_at_rest", "Pa", c.vertical_at_rest},
          {"lateral_over_vertical_stress", "-", c.ratio},
          {"phi_bulk_before_confinement", "-", c.phi_before},
          {"work_of_confinement", "J", c.work},
          {"confinement_steps", "", c.steps}};
}

std::vector<disk::Field> achieved_fields(const RunRecord& r) {
  std::vector<disk::Field> fields{{"particles", "", r.particles},
                                  {"height", "m", r.height},
                                  {"top", "m", r.top},
                                  {"phi", "-", r.phi},
                                  {"porosity", "-", porosity(r.phi)},
                                  {"void_ratio", "-", void_ratio(r.phi)},
                                  {"phi_bulk", "-", r.phi_bulk},
                                  {"porosity_bulk", "-", porosity(r.phi_bulk)},
                                  {"void_ratio_bulk", "-", void_ratio(r.phi_bulk)},
                                  {"compaction_rate", "1/s", r.compaction_rate},
                                  {"bulk", "m", std::vector<double>{r.bulk.low, r.bulk.high}},
                                  {"coordination", "-", r.rest.network.coordination},
                                  {"coordination_without_rattlers", "-", r.rest.network.held_coordination},
                                  {"rattlers", "-", r.rest.network.rattlers},
                                  {"mean_overlap", "-", r.rest.mean_overlap},
                                  {"kinetic_energy", "J", r.kinetic_energy},
                                  {"floor_force", "N", r.floor_force},
                                  {"weight", "N", r.weight},
                                  {"mean_radius", "m", r.mean_radius},
                                  {"sd_radius", "m", r.sd_radius},
                                  {"min_radius", "m", r.min_radius},
                                  {"max_radius", "m", r.max_radius},
                                  {"time_step", "s", r.time_step},
                                  {"steps", "", r.steps},
                                  {"duration", "s", r.duration},
                                  {"particle_steps", "", r.particle_steps},
                                  {"relaxations", "", r.relaxations},
                                  {"relaxation_steps", "", r.relaxation_steps},
                                  {"height_before_relaxation", "m", r.height_before_relaxation},
                                  {"reached", "", r.reached},
                                  {"stop_reason", "", r.stop_reason},
                                  {"targets_met", "", r.targets_met}};
  for (disk::Field& field : confined_fields(r.confined)) fields.push_back(std::move(field));
  return fields;
}

std::vector<disk::Field> audit_fields(const Audit& a) {
  return {{"expected", "", a.expected},
          {"found", "", a.found},
          {"lost", "", a.expected - a.found},
          {"non_finite", "", a.non_finite},
          {"outside", "", a.outside},
          {"worst_overlap", "-", a.worst_overlap},
          {"worst_wall_penetration", "-", a.worst_wall_penetration}};
}

std::vector<disk::Field> provenance_fields(const RunRecord& r) {
  std::vector<disk::Field> fields{{"version", "", r.version},
                                  {"git", "", r.git},
                                  {"compiler", "", r.compiler},
                                  {"architecture", "", r.architecture},
                                  {"scene_file", "", r.scene_file},
                                  {"effective_input", "", r.effective_input},
                                  {"petsc_options", "", r.petsc_options},
                                  {"seed", "", r.seed},
                                  {"ranks", "", std::int64_t{r.ranks}},
                                  {"decomposition", "", r.decomposition},
                                  {"wall_seconds", "s", r.wall_seconds},
                                  {"series_rows", "", r.series_rows},
                                  {"series_rows_in_file", "", r.series_rows_in_file},
                                  {"particle_steps_per_second", "1/s", r.particle_steps_per_second},
                                  {"bytes_per_particle", "", r.bytes_per_particle}};
  if (!r.start.empty()) fields.push_back({"start", "", r.start});
  return fields;
}

std::vector<LayerColumn> layer_columns(const RunRecord& record) {
  const std::vector<LayerRow>& layers = record.layers;
  std::vector<LayerColumn> columns{{"inserted", "", collect(layers, &LayerRow::inserted)},
                                   {"total", "", collect(layers, &LayerRow::total)},
                                   {"attempts", "", collect(layers, &LayerRow::attempts)},
                                   {"target_fraction", "-", collect(layers, &LayerRow::target_fraction)},
                                   {"achieved_fraction", "-", collect(layers, &LayerRow::achieved_fraction)},
                                   {"region_bottom", "m", collect(layers, &LayerRow::region_bottom)},
                                   {"height", "m", collect(layers, &LayerRow::height)},
                                   {"top", "m", collect(layers, &LayerRow::top)},
                                   {"duration", "s", collect(layers, &LayerRow::duration)},
                                   {"steps", "", collect(layers, &LayerRow::steps)},
                                   {"kinetic_per_mgd", "-", collect(layers, &LayerRow::kinetic_per_mgd)},
                                   {"max_overlap", "-", collect(layers, &LayerRow::max_overlap)},
                                   {"coordination", "-", collect(layers, &LayerRow::coordination)},
                                   {"stop_reason", "", collect(layers, &LayerRow::stop_reason)}};
  if (record.density.on()) {
    columns.push_back({"filling_friction", "-", record.density.friction});
    columns.push_back({"filling_rolling_friction", "-", record.density.rolling_friction});
    columns.push_back({"buried_fraction", "-", record.density.buried});
  }
  return columns;
}

}  // namespace packmpi::report
