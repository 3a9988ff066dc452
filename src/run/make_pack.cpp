#include "run/make_pack.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/patience.hpp"
#include "disk/text_file.hpp"
#include "observe/measure.hpp"
#include "pack/pack.hpp"
#include "report/report.hpp"
#include "report/tell.hpp"
#include "run/analyze.hpp"
#include "run/bed.hpp"
#include "run/confine.hpp"
#include "run/counters.hpp"
#include "run/files.hpp"
#include "run/fill.hpp"
#include "run/journal.hpp"
#include "run/keeper.hpp"
#include "run/record.hpp"
#include "run/restart.hpp"
#include "run/search.hpp"
#include "run/start.hpp"

namespace packmpi::run {
namespace {

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

// A run's own: the journal tells, the keeper ends; a guest listens.
class Watch final : public Attendant {
 public:
  Watch(Journal& journal, Keeper& keeper, Attendant& guest) : journal_(journal), keeper_(keeper), guest_(guest) {}
  void layer_inserted(const report::LayerRow& row) override {
    journal_.layer_inserted(row);
    guest_.layer_inserted(row);
  }
  void moment(double share) override {
    journal_.moment(share);
    guest_.moment(share);
  }
  void remark(const std::string& line) override { log::info(line); }
  void layer_settled(const report::LayerRow& row) override {
    journal_.layer_settled(row);
    guest_.layer_settled(row);
  }
  void layer_measured(const control::Filling& filling) override { journal_.layer_measured(filling); }
  void relaxation_started() override {
    journal_.relaxation_started();
    guest_.relaxation_started();
  }
  void relaxation_not_needed() override { journal_.relaxation_not_needed(); }
  void relaxed(double height, double duration) override { journal_.relaxed(height, duration); }
  [[nodiscard]] std::int64_t steps_to_look() const override { return keeper_.steps_to_look(); }
  void look() override { keeper_.look(); }
  void layer_ended() override { keeper_.layer_ended(); }
  void look_while_inserting(LocalIndex before) override { keeper_.look_while_inserting(before); }

 private:
  Journal& journal_;
  Keeper& keeper_;
  Attendant& guest_;
};

// Is there a checkpoint to go on from? It knows the filling.
bool goes_on(const comm::Comm& comm, const scene::Scene& scene, const Options& options) {
  if (options.restart.empty() || options.restart != "auto") return !options.restart.empty();
  const Files files = files_of(scene.in.name, options);
  const bool there = comm.rank() == 0 && (is_there(files.slots[0]) || is_there(files.slots[1]));
  return comm.max(std::int64_t{there ? 1 : 0}) > 0;
}

// How a run towards a target begins, found before anything is written.
control::Filling begin_filling(const comm::Comm& comm, const scene::Scene& scene, const Options& options) {
  if (!scene.in.target || goes_on(comm, scene, options)) return {};
  check_files(comm, scene, options);
  Patience patience(files_of(scene.in.name, options).stop, options.max_hours);
  return find_filling(comm, scene, [&patience] {
    const char* why = patience.why_to_end();
    if (why == nullptr) return;
    throw Error(ExitCode::stopped_early,
                fmt::format("stopped while samples for [target] were made, before anything was written: {}; "
                            "the same command begins anew",
                            why));
  });
}

// `whole`: with the search for what [target] needs; `making`: of the pack.
void take_time(const comm::Comm& comm, const Stopwatch& whole, const Stopwatch& making, const pack::Progress& before,
               report::RunRecord& record) {
  record.wall_seconds = comm.max(whole.seconds());
  record.steps_here = record.steps - before.steps;
  record.particle_steps_per_second =
      static_cast<double>(record.particle_steps - before.particle_steps) / comm.max(making.seconds());
}

// The pack in its file; the particles are let go.
report::RunRecord make(const comm::Comm& comm, const scene::Scene& scene, const Options& options, const Files& files,
                       const control::Filling& filling, const Stopwatch& whole, Attendant& guest) {
  const Stopwatch making;
  log::info(fmt::format("packmpi: scene {}, {} rank{}, seed {}", scene.in.file, comm.size(),
                        comm.size() == 1 ? "" : "s", scene.in.seed));
  for (const std::string& remark : scene.in.remarks) log::info(remark);
  std::optional<scene::Scene> moving;  // whose container a lid changes
  if (scene.in.confinement) moving = scene;
  Bed bed(comm, moving ? *moving : scene);
  if (moving) bed.box = &moving->container;
  bed.progress.filling = filling;
  const Origin origin = resume(files, options, bed);
  if (scene.in.start && !origin.restarted) take_over(bed);
  const pack::Progress before = bed.progress;
  Journal journal(bed, files.steps, options.verbosity == log::Verbosity::quiet, origin.restarted);
  Keeper keeper(bed, journal, files, options, origin);
  Watch watch_over(journal, keeper, guest);
  journal.filling_begins();
  if (!bed.progress.confined.on) fill(bed, watch_over);
  confine_bed(bed, watch_over);
  report::RunRecord record = targets_of(comm, scene);
  record.series_rows_in_file = journal.finish();
  record.series_rows_lost = bed.progress.series.in_file - record.series_rows_in_file;
  measure_bed(bed, record);
  report::tell(comm, scene, record);
  take_time(comm, whole, making, before, record);
  guest.measured(bed, record);
  write_outputs(bed, files, record);
  keeper.finished();
  return record;
}

}  // namespace

report::RunRecord make_pack(const comm::Comm& comm, const scene::Scene& scene, const Options& options,
                            Attendant* guest) {
  Attendant nobody;
  comm::agree_on(comm, [&] { check_ranks(scene, comm.size()); });  // the analysis comes last
  const Stopwatch watch;
  const control::Filling filling = begin_filling(comm, scene, options);
  Options left = options;  // of the time
  if (left.max_hours > 0.0) left.max_hours = std::max(1e-9, left.max_hours - watch.seconds() / 3600.0);
  const Claim claim = claim_files(comm, scene, options);
  report::RunRecord record = make(comm, scene, left, claim.files, filling, watch, guest != nullptr ? *guest : nobody);
  if (scene.in.output.analysis) (void)analyze(comm, claim.files.pack);
  if (record.series_rows_lost > 0) {
    comm::fail_together(comm, ExitCode::io_failure,
                        fmt::format("{} is written and whole, but {} rows of {} could not be: a warning above says why",
                                    claim.files.pack, record.series_rows_lost, claim.files.steps));
  }
  return record;
}

report::RunRecord make_in_memory(const comm::Comm& comm, const scene::Scene& scene, Attendant& guest) {
  const Stopwatch watch;
  std::optional<scene::Scene> moving;  // whose container a lid changes
  if (scene.in.confinement) moving = scene;
  Bed bed(comm, moving ? *moving : scene);
  if (moving) bed.box = &moving->container;
  if (scene.in.target) bed.progress.filling = find_filling(comm, scene);
  if (scene.in.start) take_over(bed);
  const pack::Progress before = bed.progress;
  const Stopwatch making;
  fill(bed, guest);
  confine_bed(bed, guest);
  report::RunRecord record = targets_of(comm, scene);
  measure_bed(bed, record);
  take_time(comm, watch, making, before, record);
  guest.measured(bed, record);
  return record;
}

}  // namespace packmpi::run
