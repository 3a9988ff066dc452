#include "run/make_pack.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/log.hpp"
#include "disk/text_file.hpp"
#include "geometry/volume.hpp"
#include "observe/measure.hpp"
#include "pack/pack.hpp"
#include "report/report.hpp"
#include "rsa/insert.hpp"
#include "run/analyze.hpp"
#include "run/counters.hpp"
#include "run/course.hpp"
#include "run/files.hpp"
#include "run/journal.hpp"
#include "run/keeper.hpp"
#include "run/pile.hpp"
#include "run/record.hpp"
#include "run/restart.hpp"
#include "run/settle.hpp"
#include "scene/expectation.hpp"
#include "scene/limits.hpp"

namespace packmpi::run {
namespace {

void insert_layer(Pile& pile, Keeper& keeper, report::LayerRow& row) {
  const scene::Scene& scene = pile.scene;
  pile.store.set_ghosts(0);
  const rsa::LayerRegion region{.layer = static_cast<std::uint32_t>(pile.first_ids.size()),
                                .bottom = pile.top(),
                                .thickness = scene.in.layers.thickness,
                                .first_id = pile.count};
  const LocalIndex before = pile.store.owned();
  const auto look = [&] { keeper.look_while_inserting(before); };
  const Stopwatch watch;
  const rsa::Insertion got = rsa::insert(pile.comm, scene, pile.ownership, region, pile.store, look);
  pile.inserting += watch.seconds();
  pile.first_ids.push_back(pile.count);
  pile.energy_given += observe::energy_of(pile.comm, pile.store, scene, pile.count, pile.count + got.inserted);
  pile.count += got.inserted;
  row.inserted = got.inserted;
  row.attempts = got.darts;
  row.total = pile.count;
  row.fraction_asked = scene.in.layers.fraction;
  row.fraction_got = got.solid_volume / (scene.box.floor_area() * region.thickness);
  row.region_bottom = region.bottom;
}

void settle_layer(Pile& pile, Journal& journal, Keeper& keeper, Stand& stand, report::RunRecord& record) {
  const Settled settled = settle(pile, journal, keeper, Part::layer, stand.course);
  record.creep = settled.creep;
  stand.row.steps = settled.steps;
  stand.row.duration = settled.seconds;
  stand.row.stop_reason = settled.early ? "settled" : "duration";
}

void measure_layer(const Pile& pile, report::LayerRow& row) {
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
void thaw(Pile& pile, Journal& journal, Keeper& keeper, Stand& stand, report::RunRecord& record) {
  if (!(pile.scene.thaw > 0.0) && pile.moving_from == 0) return;
  pile.thaw();
  pile.balance();
  journal.thaw_started();
  record.height_before_thaw = record.height;
  if (pile.scene.thaw > 0.0) {
    record.creep = settle(pile, journal, keeper, Part::thaw, stand.course).creep;
  }
  ++record.thaws;
  record.height = pile.height();
  journal.thawed(record.height);
}

void insert_and_settle(Pile& pile, Journal& journal, Keeper& keeper, Stand& stand, report::RunRecord& record) {
  if (stand.phase == pack::Phase::insertion) {
    insert_layer(pile, keeper, stand.row);
    pile.freeze_older();
    pile.balance();
    journal.layer_inserted(stand.row);
    stand.phase = pack::Phase::settling;
  }
  settle_layer(pile, journal, keeper, stand, record);
  measure_layer(pile, stand.row);
  journal.layer_settled(stand.row);
  record.height = stand.row.height;
  record.layers.push_back(stand.row);
}

// What a pile sinks by at most in the final stage, over a layer's rise: measured (doc/accuracy.md).
double sinks_by(const input::Input& in) {
  constexpr double rough = 0.3;
  if (in.dynamics.rotation) return 0.45;
  return in.contact.friction > rough ? 1.1 : 0.6;
}

// The pile's height after the final stage [m]: as it is if that is over, else less by what it is going to sink. A layer
// too few costs a second final stage, in which all that lies there creeps again.
double final_height(const scene::Scene& scene, const report::RunRecord& record) {
  if (!(scene.thaw > 0.0) || record.layers.empty()) return record.height;
  const bool over = record.thaws > 0 && record.height_before_thaw == record.layers.back().height;
  if (over) return record.height;
  return record.height - sinks_by(scene.in) * scene::rise_of_layer(scene, scene::expected_fraction(scene).value);
}

// The loop of Algorithm 1, and the final stage; more layers if the pile sank in it. From where `stand` says.
// Bounded.
void pile_up(Pile& pile, Journal& journal, Keeper& keeper, Stand& stand, report::RunRecord& record) {
  const std::int64_t most = scene::most_layers(pile.scene.in);
  const auto more = [&] {
    return final_height(pile.scene, record) < record.height_asked &&
           static_cast<std::int64_t>(record.layers.size()) < most;
  };
  while (stand.phase != pack::Phase::insertion || more()) {
    if (stand.phase == pack::Phase::thaw) {
      thaw(pile, journal, keeper, stand, record);
      stand = {};
    } else {
      insert_and_settle(pile, journal, keeper, stand, record);
      stand = {.phase = more() ? pack::Phase::insertion : pack::Phase::thaw};
    }
    keeper.layer_ended();
  }
  record.reached = record.height >= record.height_asked;
  record.stop_reason = record.reached ? "height" : "layers.maximum";
}

void write_outputs(const Pile& pile, const Files& files, report::RunRecord& record) {
  const observe::Contacts contacts =
      observe::contacts(pile.comm, pile.store, pile.scene, pile.neighborhood.pairs(), pile.neighborhood.walls());
  std::vector<pack::ContactRow> rows;
  if (pile.scene.in.output.contacts) {
    for (const observe::ContactForce& c : observe::contact_forces(pile.store, pile.scene, pile.neighborhood.pairs())) {
      rows.push_back({c.first, c.second, c.overlap, c.force});
    }
  }
  const std::vector<std::int32_t> layers = pile.layers();
  const pack::PackParts parts{.store = &pile.store,
                              .layer = layers,
                              .contacts = contacts.of_particle,
                              .contact_rows = pile.scene.in.output.contacts ? &rows : nullptr};
  pack::write_pack(pile.comm, files.pack, parts, record);
  count(pile, contacts.pairs_here, record);
  disk::write_text(pile.comm, files.summary, report::to_json(record));
}

// How near the sizes are to those asked; one line of the log.
void tell_sizes(const scene::Scene& scene, const observe::SizeMatches& sizes) {
  if (scene.sizes.equal()) return;
  log::event("sizes",
             fmt::format("sizes: D50 by mass {:.4g} m, asked {:.4g}; Cu {:.3g}, asked {:.3g}; the curves differ by at "
                         "most {:.2g} by number, {:.2g} by mass",
                         sizes.by_mass.got.d50, sizes.by_mass.asked.d50, sizes.by_mass.got.uniformity(),
                         sizes.by_mass.asked.uniformity(), sizes.by_number.distance, sizes.by_mass.distance),
             {{"d50_by_mass", sizes.by_mass.got.d50},
              {"d50_by_mass_asked", sizes.by_mass.asked.d50},
              {"cu_by_mass", sizes.by_mass.got.uniformity()},
              {"cu_by_mass_asked", sizes.by_mass.asked.uniformity()},
              {"distance_by_number", sizes.by_number.distance},
              {"distance_by_mass", sizes.by_mass.distance}});
}

// The pack in its file; the particles are let go.
report::RunRecord make(const comm::Comm& comm, const scene::Scene& scene, const Options& options, const Files& files) {
  const Stopwatch watch;
  log::info(fmt::format("packmpi: scene {}, {} rank{}, seed {}", scene.in.file, comm.size(),
                        comm.size() == 1 ? "" : "s", scene.in.seed));
  Pile pile(comm, scene);
  report::RunRecord record = asked(comm, scene);
  Stand stand;
  const Origin origin = resume(files, options, pile, stand, record);
  Keeper keeper(pile, stand, record, files, options, origin);
  Journal journal(pile, files.steps, options.verbosity == log::Verbosity::quiet, origin.restarted, record.layers);
  pile_up(pile, journal, keeper, stand, record);
  journal.finish();
  got(pile, record);
  tell_sizes(scene, record.sizes);
  record.wall_seconds = comm.max(watch.seconds());
  record.particle_steps_per_second =
      static_cast<double>(record.particle_steps - pile.earlier_particle_steps) / record.wall_seconds;
  write_outputs(pile, files, record);
  keeper.finished();
  return record;
}

}  // namespace

report::RunRecord make_pack(const comm::Comm& comm, const scene::Scene& scene, const Options& options) {
  const Files files = claim_files(comm, scene, options);
  report::RunRecord record = make(comm, scene, options, files);
  if (scene.in.output.analysis) (void)analyze(comm, files.pack);
  return record;
}

bool targets_met(const report::RunRecord& record) {
  constexpr double deepest = 0.5;  // of a radius: no sound pack has such overlaps
  const report::Audit& audit = record.audit;
  return record.reached && audit.found == audit.expected && audit.non_finite == 0 && audit.outside == 0 &&
         audit.worst_overlap < deepest && audit.worst_wall_penetration < deepest;
}

}  // namespace packmpi::run
