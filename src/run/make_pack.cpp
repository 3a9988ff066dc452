#include "run/make_pack.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/log.hpp"
#include "geometry/volume.hpp"
#include "observe/measure.hpp"
#include "output/pack.hpp"
#include "output/report.hpp"
#include "rsa/insert.hpp"
#include "run/files.hpp"
#include "run/journal.hpp"
#include "run/pile.hpp"
#include "run/record.hpp"
#include "run/settle.hpp"

namespace packmpi::run {
namespace {

// Every layer adds phi_0 h_0 of solid and no pile is denser than solid: more layers than this never come to H_d.
std::int64_t most_layers(const scene::Scene& scene) {
  const input::Layers& layers = scene.in.layers;
  if (layers.maximum > 0) return layers.maximum;
  return static_cast<std::int64_t>(std::ceil(scene.box.height() / (layers.fraction * layers.thickness))) + 2;
}

void insert_layer(Pile& pile, output::LayerRow& row) {
  const scene::Scene& scene = pile.scene;
  pile.store.set_ghosts(0);
  const rsa::LayerRegion region{.layer = static_cast<std::uint32_t>(pile.first_ids.size()),
                                .bottom = pile.top(),
                                .thickness = scene.in.layers.thickness,
                                .first_id = pile.count};
  const rsa::Insertion got = rsa::insert(pile.comm, scene, pile.ownership, region, pile.store);
  pile.first_ids.push_back(pile.count);
  pile.count += got.inserted;
  row.inserted = got.inserted;
  row.attempts = got.darts;
  row.total = pile.count;
  row.fraction_asked = scene.in.layers.fraction;
  row.fraction_got = got.solid_volume / (scene.box.floor_area() * region.thickness);
  row.region_bottom = region.bottom;
}

void balance(Pile& pile) {
  if (pile.ownership.rebalance(pile.neighborhood.column_counts(pile.store))) {
    pile.neighborhood.ownership_changed();
    log::debug("columns were shared out anew");
  }
  pile.neighborhood.rebuild(pile.store);
}

void settle_layer(Pile& pile, Journal& journal, output::LayerRow& row, output::RunRecord& record) {
  Course course;
  const Settled settled = settle(pile, journal, Part::layer, course);
  record.creep = settled.creep;
  row.steps = settled.steps;
  row.duration = settled.seconds;
  row.stop_reason = settled.early ? "settled" : "duration";
}

void measure_layer(const Pile& pile, output::LayerRow& row) {
  const scene::Scene& scene = pile.scene;
  const observe::Contacts contacts = observe::contacts(pile.comm, pile.store, scene, pile.neighborhood.pairs(),
                                                       pile.neighborhood.walls(), pile.moving_from);
  const observe::Motion motion = observe::motion(pile.comm, pile.store, scene);
  row.height = pile.height();
  row.top = pile.top();
  row.max_overlap = contacts.max_overlap;
  row.coordination = contacts.coordination;
  const double mgd = motion.mass * scene.in.jamming.gravity * 2.0 * scene.sizes.mean();  // of all particles together
  row.kinetic_per_mgd = mgd > 0.0 ? motion.kinetic_energy / mgd : 0.0;
}

// The final stage: every particle moves for scene.thaw. The height is that after it.
void thaw(Pile& pile, Journal& journal, output::RunRecord& record) {
  if (!(pile.scene.thaw > 0.0) && pile.moving_from == 0) return;
  pile.thaw();
  balance(pile);
  journal.thaw_started();
  record.height_before_thaw = record.height;
  if (pile.scene.thaw > 0.0) {
    Course course;
    record.creep = settle(pile, journal, Part::thaw, course).creep;
  }
  ++record.thaws;
  record.height = pile.height();
  journal.thawed(record.height);
}

// The loop of Algorithm 1, and the final stage; more layers if the pile sank in it. Bounded.
void pile_up(Pile& pile, Journal& journal, output::RunRecord& record) {
  const std::int64_t most = most_layers(pile.scene);
  const auto more = [&] {
    return record.height < record.height_asked && static_cast<std::int64_t>(record.layers.size()) < most;
  };
  while (more()) {
    output::LayerRow row;
    insert_layer(pile, row);
    pile.freeze_older();
    balance(pile);
    journal.layer_inserted(row);
    settle_layer(pile, journal, row, record);
    measure_layer(pile, row);
    journal.layer_settled(row);
    record.height = row.height;
    record.layers.push_back(row);
    if (!more()) thaw(pile, journal, record);
  }
  record.reached = record.height >= record.height_asked;
  record.stop_reason = record.reached ? "height" : "layers.maximum";
}

void write_outputs(const Pile& pile, const Files& files, const output::RunRecord& record) {
  const observe::Contacts contacts =
      observe::contacts(pile.comm, pile.store, pile.scene, pile.neighborhood.pairs(), pile.neighborhood.walls());
  std::vector<output::ContactRow> rows;
  if (pile.scene.in.output.contacts) {
    for (const observe::ContactForce& c : observe::contact_forces(pile.store, pile.scene, pile.neighborhood.pairs())) {
      rows.push_back({c.first, c.second, c.overlap, c.force});
    }
  }
  const std::vector<std::int32_t> layers = pile.layers();
  const output::PackParts parts{.store = &pile.store,
                                .layer = layers,
                                .contacts = contacts.of_particle,
                                .contact_rows = pile.scene.in.output.contacts ? &rows : nullptr};
  output::write_pack(pile.comm, files.pack, parts, record);
  output::write_text(pile.comm, files.summary, output::to_json(record));
}

}  // namespace

output::RunRecord make_pack(const comm::Comm& comm, const scene::Scene& scene, const Options& options) {
  const Stopwatch watch;
  const Files files = claim_files(comm, scene, options);
  log::info(fmt::format("packmpi: scene {}, {} rank{}, seed {}", scene.in.file, comm.size(),
                        comm.size() == 1 ? "" : "s", scene.in.seed));
  Pile pile(comm, scene);
  output::RunRecord record = asked(comm, scene);
  Journal journal(pile, files.steps, options.verbosity == log::Verbosity::quiet);
  pile_up(pile, journal, record);
  journal.finish();
  got(pile, record);
  record.wall_seconds = comm.max(watch.seconds());
  record.particle_steps_per_second = static_cast<double>(record.particle_steps) / record.wall_seconds;
  write_outputs(pile, files, record);
  return record;
}

bool targets_met(const output::RunRecord& record) {
  constexpr double deepest = 0.5;  // of a radius: no sound pack has such overlaps
  const output::Audit& audit = record.audit;
  return record.reached && audit.found == audit.expected && audit.non_finite == 0 && audit.outside == 0 &&
         audit.worst_overlap < deepest && audit.worst_wall_penetration < deepest;
}

}  // namespace packmpi::run
