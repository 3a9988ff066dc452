#include "report/tell.hpp"

#include <fmt/core.h>

#include <string>

#include "base/log.hpp"
#include "base/voids.hpp"
#include "report/report.hpp"

namespace packmpi::report {
namespace {

// How near the sizes are to those asked; one line of the log.
void tell_sizes(const scene::Scene& scene, const observe::SizeMatches& sizes) {
  if (scene.sizes.equal()) return;
  log::event(
      "sizes",
      fmt::format("sizes: D50 by mass {:.4g} m, target {:.4g}; Cu {:.3g}, target {:.3g}; the curves differ by at "
                  "most {:.2g} by number, {:.2g} by mass",
                  sizes.by_mass.achieved.d50, sizes.by_mass.target.d50, sizes.by_mass.achieved.uniformity(),
                  sizes.by_mass.target.uniformity(), sizes.by_number.distance, sizes.by_mass.distance),
      {{"d50_by_mass", sizes.by_mass.achieved.d50},
       {"target_d50_by_mass", sizes.by_mass.target.d50},
       {"cu_by_mass", sizes.by_mass.achieved.uniformity()},
       {"target_cu_by_mass", sizes.by_mass.target.uniformity()},
       {"distance_by_number", sizes.by_number.distance},
       {"distance_by_mass", sizes.by_mass.distance}});
}

void tell_density(const RunRecord& record) {
  const double phi = record.phi_bulk;
  log::event("density",
             fmt::format("density of the bulk: solid fraction {:.4f}, porosity {:.4f}, void ratio {:.4f}", phi,
                         porosity(phi), void_ratio(phi)),
             {{"phi_bulk", phi}, {"porosity_bulk", porosity(phi)}, {"void_ratio_bulk", void_ratio(phi)}});
}

// What there is of each component, and where strata meet.
void tell_composition(const RunRecord& record) {
  for (const std::string& line : composition_log(record)) log::info(line);
}

void tell_stress(const confine::Outcome& got) {
  if (!got.on) return;
  log::event("stress",
             fmt::format("confinement: {:.4g} Pa on the lid at {:.6g} m, {:.4g} Pa of the contacts (at rest {:.4g}), "
                         "lateral over vertical {:.3f}; solid fraction {:.4f} before",
                         got.on_lid, got.lid, got.of_contacts.back(), got.vertical_at_rest, got.ratio, got.phi_before),
             {{"lid", got.lid},
              {"stress_on_lid", got.on_lid},
              {"vertical_stress_of_contacts", got.of_contacts.back()},
              {"lateral_over_vertical_stress", got.ratio},
              {"phi_bulk_before", got.phi_before}});
}

// How near to rest, and what was missed.
void tell_rest(const comm::Comm& comm, const RunRecord& record) {
  std::string line = "rest:";
  for (const Criterion& c : record.criteria) {
    line += fmt::format("{} {} {:.2e}", line.back() == ':' ? "" : ",", c.words, c.value);
  }
  log::event("rest", line,
             {{"unbalanced_force", record.rest.unbalanced_force},
              {"kinetic_energy", record.rest.kinetic_energy},
              {"support", record.rest.support},
              {"mean_overlap", record.rest.mean_overlap},
              {"worst_overlap", record.rest.worst_overlap},
              {"rattlers", record.rest.network.rattlers},
              {"coordination", record.rest.network.coordination},
              {"coordination_without_rattlers", record.rest.network.held_coordination}});
  if (comm.rank() != 0) return;
  for (const std::string& words : record.missed) log::warn("missed: " + words);
}

}  // namespace

void tell(const comm::Comm& comm, const scene::Scene& scene, const RunRecord& record) {
  tell_density(record);
  tell_stress(record.confined);
  tell_sizes(scene, record.sizes);
  tell_composition(record);
  tell_rest(comm, record);
}

}  // namespace packmpi::report
