#include "report/fields.hpp"

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

std::vector<disk::Field> asked_fields(const RunRecord& r) {
  return {{"name", "", r.name},
          {"dimension", "", std::int64_t{r.dimension}},
          {"size", "m", lengths(r)},
          {"height_asked", "m", r.height_asked},
          {"fraction_asked", "-", r.fraction_asked},
          {"mean_radius_asked", "m", r.mean_radius_asked},
          {"sd_radius_asked", "m", r.sd_radius_asked},
          {"min_radius_asked", "m", r.min_radius_asked},
          {"max_radius_asked", "m", r.max_radius_asked}};
}

std::vector<disk::Field> got_fields(const RunRecord& r) {
  return {{"particles", "", r.particles},
          {"height", "m", r.height},
          {"top", "m", r.top},
          {"phi", "-", r.phi},
          {"phi_bulk", "-", r.phi_bulk},
          {"creep", "1/s", r.creep},
          {"coordination", "-", r.coordination},
          {"rattlers", "-", r.rattlers},
          {"mean_overlap", "-", r.mean_overlap},
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
          {"thaws", "", r.thaws},
          {"thaw_steps", "", r.thaw_steps},
          {"height_before_thaw", "m", r.height_before_thaw},
          {"reached", "", r.reached},
          {"stop_reason", "", r.stop_reason}};
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
  return {{"version", "", r.version},
          {"git", "", r.git},
          {"compiler", "", r.compiler},
          {"architecture", "", r.architecture},
          {"scene_file", "", r.scene_file},
          {"effective_input", "", r.effective_input},
          {"seed", "", r.seed},
          {"ranks", "", std::int64_t{r.ranks}},
          {"decomposition", "", r.decomposition},
          {"wall_seconds", "s", r.wall_seconds},
          {"particle_steps_per_second", "1/s", r.particle_steps_per_second},
          {"bytes_per_particle", "", r.bytes_per_particle}};
}

std::vector<LayerColumn> layer_columns(const std::vector<LayerRow>& layers) {
  return {{"inserted", "", collect(layers, &LayerRow::inserted)},
          {"total", "", collect(layers, &LayerRow::total)},
          {"attempts", "", collect(layers, &LayerRow::attempts)},
          {"fraction_asked", "-", collect(layers, &LayerRow::fraction_asked)},
          {"fraction_got", "-", collect(layers, &LayerRow::fraction_got)},
          {"region_bottom", "m", collect(layers, &LayerRow::region_bottom)},
          {"height", "m", collect(layers, &LayerRow::height)},
          {"top", "m", collect(layers, &LayerRow::top)},
          {"duration", "s", collect(layers, &LayerRow::duration)},
          {"steps", "", collect(layers, &LayerRow::steps)},
          {"kinetic_per_mgd", "-", collect(layers, &LayerRow::kinetic_per_mgd)},
          {"max_overlap", "-", collect(layers, &LayerRow::max_overlap)},
          {"coordination", "-", collect(layers, &LayerRow::coordination)},
          {"stop_reason", "", collect(layers, &LayerRow::stop_reason)}};
}

}  // namespace packmpi::report
