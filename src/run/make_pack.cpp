#include "run/make_pack.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/log.hpp"
#include "base/voids.hpp"
#include "disk/text_file.hpp"
#include "geometry/volume.hpp"
#include "observe/measure.hpp"
#include "pack/pack.hpp"
#include "report/report.hpp"
#include "rsa/insert.hpp"
#include "run/analyze.hpp"
#include "run/bed.hpp"
#include "run/counters.hpp"
#include "run/files.hpp"
#include "run/journal.hpp"
#include "run/judge.hpp"
#include "run/keeper.hpp"
#include "run/record.hpp"
#include "run/restart.hpp"
#include "run/settle.hpp"
#include "run/start.hpp"
#include "scene/expectation.hpp"
#include "scene/limits.hpp"

namespace packmpi::run {
namespace {

void insert_layer(Bed& bed, Keeper& keeper) {
  const scene::Scene& scene = bed.scene;
  pack::Progress& at = bed.progress;
  bed.store.set_ghosts(0);
  const rsa::LayerRegion region = bed.next_region();
  const LocalIndex before = bed.store.owned();
  const auto look = [&] { keeper.look_while_inserting(before); };
  const Stopwatch watch;
  const rsa::Insertion got = rsa::insert(bed.comm, scene, bed.ownership, region, bed.store, look);
  bed.inserting += watch.seconds();
  at.first_ids.push_back(at.count);
  at.energy_given += observe::energy_of(bed.comm, bed.store, scene, at.count, at.count + got.inserted);
  at.count += got.inserted;
  report::LayerRow& row = at.now.row;
  row.inserted = got.inserted;
  row.attempts = got.trials;
  row.total = at.count;
  row.target_fraction = scene.in.layers.fraction;
  row.achieved_fraction = got.solid_volume / (scene.container.floor_area() * region.thickness);
  row.region_bottom = region.bottom;
}

void settle_layer(Bed& bed, Journal& journal, Keeper& keeper) {
  const Settled settled = settle(bed, journal, keeper, Part::layer);
  bed.progress.compaction_rate = settled.compaction_rate;
  report::LayerRow& row = bed.progress.now.row;
  row.steps = settled.steps;
  row.duration = settled.seconds;
  row.stop_reason = settled.early ? "settled" : insertion_alone(bed.scene.in) ? "inserted" : "duration";
}

void measure_layer(Bed& bed) {
  const scene::Scene& scene = bed.scene;
  const observe::Contacts contacts = observe::contacts(bed.comm, bed.store, scene, bed.neighborhood.pairs(),
                                                       bed.neighborhood.walls(), bed.progress.moving_from);
  const observe::Motion motion = observe::motion(bed.comm, bed.store, scene);
  report::LayerRow& row = bed.progress.now.row;
  row.height = bed.height();
  row.top = bed.top();
  row.max_overlap = contacts.max_overlap;
  row.coordination = contacts.coordination;
  const double mgd = motion.mass * scene.in.jamming.gravity * 2.0 * scene.sizes.mean();  // of all particles together
  row.kinetic_per_mgd = mgd > 0.0 ? motion.kinetic_energy / mgd : 0.0;
}

// The final stage: every particle moves for scene.relaxation, and on until the bed is at rest, for scene.wait at most.
// The height is that after it. A bed that is at rest and had no window has none.
void relax(Bed& bed, Journal& journal, Keeper& keeper) {
  pack::Progress& at = bed.progress;
  const bool needed = bed.scene.relaxation > 0.0 || at.moving_from > 0;
  if (!needed && !(bed.scene.wait > 0.0)) return;
  bed.release();
  bed.balance();
  journal.relaxation_started();
  const double height_before = at.height;
  const Settled settled = settle(bed, journal, keeper, Part::relaxation);
  if (settled.steps > 0) at.compaction_rate = settled.compaction_rate;
  if (!needed && settled.steps == 0) return journal.relaxation_not_needed();
  at.height_before_relaxation = height_before;
  ++at.relaxations;
  at.height = bed.height();
  journal.relaxed(at.height, settled.seconds);
}

void insert_and_settle(Bed& bed, Journal& journal, Keeper& keeper) {
  pack::Progress& at = bed.progress;
  if (at.now.phase == pack::Phase::insertion) {
    insert_layer(bed, keeper);
    bed.freeze_older();
    bed.balance();
    journal.layer_inserted(at.now.row);
    at.now.phase = pack::Phase::settling;
  }
  settle_layer(bed, journal, keeper);
  measure_layer(bed);
  journal.layer_settled(at.now.row);
  at.height = at.now.row.height;
  at.layers.push_back(at.now.row);
  comm::agree_on(bed.comm, [&] { check_energy(bed.scene, at.layers); });
}

// What a bed sinks by at most in the final stage, over a layer's rise: measured (doc/accuracy.md).
double sinks_by(const input::Input& in) {
  constexpr double rough = 0.3;
  if (in.dynamics.rotation) return 0.45;
  return in.contact.friction > rough ? 1.1 : 0.6;
}

// The bed's height after the final stage [m]: as it is if that is over, else less by what it is going to sink. A layer
// too few costs a second final stage, in which all that lies there creeps again.
double final_height(const scene::Scene& scene, const pack::Progress& at) {
  if (!(scene.relaxation > 0.0) || at.layers.empty() || at.layers.back().stop_reason == taken_over) return at.height;
  const bool over = at.relaxations > 0 && at.height_before_relaxation == at.layers.back().height;
  if (over) return at.height;
  return at.height - sinks_by(scene.in) * scene::rise_of_layer(scene, scene::expected_fraction(scene).value);
}

// Collective. Does the bed take another layer?
bool takes_more(const Bed& bed) {
  const std::int64_t count = bed.scene.in.particles.count;
  if (insertion_alone(bed.scene.in)) return bed.progress.count == 0;
  if (std::ssize(bed.progress.layers) >= scene::most_layers(bed.scene)) return false;
  if (count > 0) return bed.progress.count < count && !bed.full();
  if (bed.scene.in.layers.region == input::RegionRule::container) return !bed.full();
  return final_height(bed.scene, bed.progress) < bed.scene.container.height();
}

// The loop of Algorithm 1, and the final stage; more layers if the bed sank in it. From where bed.progress says.
// Bounded.
void fill(Bed& bed, Journal& journal, Keeper& keeper) {
  pack::Progress& at = bed.progress;
  const auto more = [&] { return takes_more(bed); };
  while (at.now.phase != pack::Phase::insertion || more()) {
    if (at.now.phase == pack::Phase::relaxation) {
      relax(bed, journal, keeper);
      at.now = {};
    } else {
      insert_and_settle(bed, journal, keeper);
      at.now = {.phase = more() ? pack::Phase::insertion : pack::Phase::relaxation};
    }
    keeper.layer_ended();
  }
}

void write_outputs(const Bed& bed, const Files& files, report::RunRecord& record) {
  const observe::Contacts contacts =
      observe::contacts(bed.comm, bed.store, bed.scene, bed.neighborhood.pairs(), bed.neighborhood.walls());
  const bool with_contacts = bed.scene.in.output.contacts;
  std::vector<pack::ContactRow> rows, wall_rows;
  if (with_contacts) {
    const neighbor::Neighborhood& near = bed.neighborhood;
    rows = observe::contact_forces(bed.store, bed.scene, near.pairs(), dynamics::stored_pairs(near));
    wall_rows = observe::wall_forces(bed.store, bed.scene, near.walls(), dynamics::stored_walls(near));
  }
  const std::vector<std::int32_t> layers = bed.layers();
  const observe::ColumnMaps maps = observe::column_maps(bed.comm, bed.store, bed.scene, bed.neighborhood.pairs(),
                                                        dynamics::stored_pairs(bed.neighborhood));
  const pack::PackParts parts{.store = &bed.store,
                              .layer = layers,
                              .contacts = contacts.of_particle,
                              .contact_rows = with_contacts ? &rows : nullptr,
                              .maps = &maps,
                              .wall_rows = &wall_rows,
                              .features = bed.scene.features};
  pack::write_pack(bed.comm, files.pack, parts, record);
  comm::agree_on(bed.comm, [&] {
    if (bed.comm.rank() == 0) record.pack_seal = pack::seal_of(files.pack);
  });
  count(bed, contacts.pairs_here, record);
  disk::write_text(bed.comm, files.summary, report::to_json(record));
}

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

void tell_density(const report::RunRecord& record) {
  const double phi = record.phi_bulk;
  log::event("density",
             fmt::format("density of the bulk: solid fraction {:.4f}, porosity {:.4f}, void ratio {:.4f}", phi,
                         porosity(phi), void_ratio(phi)),
             {{"phi_bulk", phi}, {"porosity_bulk", porosity(phi)}, {"void_ratio_bulk", void_ratio(phi)}});
}

// How near to rest, and what was missed.
void tell_rest(const comm::Comm& comm, const report::RunRecord& record) {
  std::string line = "rest:";
  for (const report::Criterion& c : record.criteria) {
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

// The pack in its file; the particles are let go.
report::RunRecord make(const comm::Comm& comm, const scene::Scene& scene, const Options& options, const Files& files) {
  const Stopwatch watch;
  log::info(fmt::format("packmpi: scene {}, {} rank{}, seed {}", scene.in.file, comm.size(),
                        comm.size() == 1 ? "" : "s", scene.in.seed));
  for (const std::string& remark : scene.in.remarks) log::info(remark);
  Bed bed(comm, scene);
  const Origin origin = resume(files, options, bed);
  if (scene.in.start && !origin.restarted) take_over(bed);
  const pack::Progress before = bed.progress;
  Journal journal(bed, files.steps, options.verbosity == log::Verbosity::quiet, origin.restarted);
  Keeper keeper(bed, journal, files, options, origin);
  fill(bed, journal, keeper);
  report::RunRecord record = targets_of(comm, scene);
  record.series_rows_in_file = journal.finish();
  record.series_rows_lost = bed.progress.series.in_file - record.series_rows_in_file;
  measure_bed(bed, record);
  tell_density(record);
  tell_sizes(scene, record.sizes);
  tell_rest(comm, record);
  record.wall_seconds = comm.max(watch.seconds());
  record.steps_here = record.steps - before.steps;
  record.particle_steps_per_second =
      static_cast<double>(record.particle_steps - before.particle_steps) / record.wall_seconds;
  write_outputs(bed, files, record);
  keeper.finished();
  return record;
}

}  // namespace

report::RunRecord make_pack(const comm::Comm& comm, const scene::Scene& scene, const Options& options) {
  const Claim claim = claim_files(comm, scene, options);
  report::RunRecord record = make(comm, scene, options, claim.files);
  if (scene.in.output.analysis) (void)analyze(comm, claim.files.pack);
  if (record.series_rows_lost > 0) {
    comm::fail_together(comm, ExitCode::io_failure,
                        fmt::format("{} is written and whole, but {} rows of {} could not be: a warning above says why",
                                    claim.files.pack, record.series_rows_lost, claim.files.steps));
  }
  return record;
}

}  // namespace packmpi::run
