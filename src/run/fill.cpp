#include "run/fill.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/timer.hpp"
#include "control/filling.hpp"
#include "control/sample.hpp"
#include "observe/measure.hpp"
#include "report/judge.hpp"
#include "rsa/insert.hpp"
#include "rsa/mixing.hpp"
#include "run/settle.hpp"
#include "scene/expectation.hpp"
#include "scene/limits.hpp"
#include "start/taken.hpp"

namespace packmpi::run {
namespace {

// Solid fraction of the buried part of a bed that has come to rest; else 0. Collective.
double settled_fraction(const Bed& bed) {
  constexpr double at_rest = 1e-2;  // of m g d
  const pack::Progress& at = bed.progress;
  if (at.layers.empty() || !(at.layers.back().kinetic_per_mgd < at_rest)) return 0.0;
  const control::Slab slab = control::buried(bed.surface(), 2.0 * bed.scene.sizes.mean());
  return slab.depth() > 0.0 ? bed.fraction_of(slab) : 0.0;
}

void insert_layer(Bed& bed, Attendant& attendant) {
  const scene::Scene& scene = bed.scene;
  pack::Progress& at = bed.progress;
  bed.store.set_ghosts(0);
  rsa::LayerRegion region = bed.next_region();
  control::Mixing mixing = at.mixing;
  if (scene.features.mixture) rsa::plan_layer(bed.comm, scene, settled_fraction(bed), mixing, region);
  const LocalIndex before = bed.store.owned();
  const auto look = [&] { attendant.look_while_inserting(before); };
  const Stopwatch watch;
  const rsa::Insertion got = rsa::insert(bed.comm, scene, bed.ownership, region, bed.store, look);
  bed.inserting += watch.seconds();
  at.first_ids.push_back(at.count);
  at.mixing = std::move(mixing);
  at.energy_given += observe::energy_of(bed.comm, bed.store, scene, at.count, at.count + got.inserted);
  at.count += got.inserted;
  if (at.filling.on) at.filling.layer_knobs.push_back(at.filling.knob);
  report::LayerRow& row = at.now.row;
  row.inserted = got.inserted;
  row.attempts = got.trials;
  row.total = at.count;
  row.target_fraction = scene.in.layers.fraction;
  row.achieved_fraction =
      got.solid_volume / (scene.container.mean_area(region.bottom, region.thickness) * region.thickness);
  row.region_bottom = region.bottom;
}

void settle_layer(Bed& bed, Attendant& attendant) {
  const Settled settled = settle(bed, attendant, Part::layer);
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

// What the buried part of the bed has come to corrects the friction that the next layer is filled in with.
void measure_filling(Bed& bed, Attendant& attendant) {
  const double surface = bed.surface();
  const control::Slab slab = control::buried(surface, 2.0 * bed.scene.sizes.mean());
  control::correct(bed.progress.filling, surface, slab, slab.depth() > 0.0 ? bed.fraction_of(slab) : 0.0,
                   control::squeeze_of(bed.scene, surface, slab));
  attendant.layer_measured(bed.progress.filling);
}

// The final stage: every particle moves for scene.relaxation, and on until the bed is at rest, for scene.wait at most.
// The height is that after it. A bed that is at rest and had no window has none.
void relax(Bed& bed, Attendant& attendant) {
  pack::Progress& at = bed.progress;
  const bool needed = bed.scene.relaxation > 0.0 || at.moving_from > 0;
  if (!needed && !(bed.scene.wait > 0.0)) return;
  bed.release();
  bed.balance();
  attendant.relaxation_started();
  const double height_before = at.height;
  const Settled settled = settle(bed, attendant, Part::relaxation);
  if (settled.steps > 0) at.compaction_rate = settled.compaction_rate;
  if (!needed && settled.steps == 0) return attendant.relaxation_not_needed();
  at.height_before_relaxation = height_before;
  ++at.relaxations;
  at.height = bed.height();
  attendant.relaxed(at.height, settled.seconds);
}

void insert_and_settle(Bed& bed, Attendant& attendant) {
  pack::Progress& at = bed.progress;
  if (at.now.phase == pack::Phase::insertion) {
    insert_layer(bed, attendant);
    bed.freeze_older();
    bed.balance();
    attendant.layer_inserted(at.now.row);
    at.now.phase = pack::Phase::settling;
  }
  settle_layer(bed, attendant);
  measure_layer(bed);
  attendant.layer_settled(at.now.row);
  if (at.filling.on) measure_filling(bed, attendant);
  at.height = at.now.row.height;
  at.layers.push_back(at.now.row);
  const auto taken = static_cast<std::size_t>(std::ranges::count_if(at.layers, start::is_taken_over));
  comm::agree_on(bed.comm, [&] { report::check_energy(bed.scene, at.layers, taken); });
}

// What a bed of friction without memory sinks by at most in the final stage, over a layer's rise: it creeps. Measured
// (doc/accuracy.md).
double creeps_by(const input::Input& in) {
  constexpr double rough = 0.3;
  if (in.dynamics.rotation) return 0.45;
  return in.contact.friction > rough ? 1.1 : 0.6;
}

// What a bed sinks by in the final stage [m], measured (doc/theory.md). With memory only its newest layers do, more if
// they harden; and frozen layers give way once they feel the weight of what came after them, by the strain of contacts
// that overlap as they are going to.
double sinks_by(const scene::Scene& scene, const pack::Progress& at) {
  constexpr double hard = 0.05, soft = 0.2, strain_of_overlap = 1.6;
  const double rise = scene::rise_of_layer(scene, scene::expected_fraction(scene).value);
  if (!scene.features.memory) return creeps_by(scene.in) * rise;
  const double modulus = scene.in.particles.youngs_modulus;
  const double newest = (scene.settling.youngs_modulus < modulus ? soft : hard) * rise;
  if (at.moving_from == 0) return newest;
  return newest + strain_of_overlap * scene::expected_overlap(scene, modulus) * at.height;
}

// The bed's height after the final stage [m]: as it is if that is over, else less by what it is going to sink. A layer
// too few costs a second final stage, in which all that lies there creeps again.
double final_height(const scene::Scene& scene, const pack::Progress& at) {
  if (!(scene.relaxation > 0.0) || at.layers.empty() || start::is_taken_over(at.layers.back())) return at.height;
  const bool over = at.relaxations > 0 && at.height_before_relaxation == at.layers.back().height;
  return over ? at.height : at.height - sinks_by(scene, at);
}

// Collective. Does the bed take another layer?
bool takes_more(const Bed& bed) {
  const std::int64_t count = bed.scene.in.particles.count;
  if (insertion_alone(bed.scene.in)) return bed.progress.count == 0;
  if (std::ssize(bed.progress.layers) >= scene::most_layers(bed.scene)) return false;
  if (control::by_mass(bed.scene)) return control::wants_mass(bed.scene, bed.progress.mixing);
  if (count > 0) return bed.progress.count < count && !bed.full();
  if (bed.scene.in.layers.region == input::RegionRule::container) return !bed.full();
  return final_height(bed.scene, bed.progress) < bed.scene.container.height();
}

}  // namespace

void fill(Bed& bed, Attendant& attendant) {
  pack::Progress& at = bed.progress;
  const auto more = [&] { return takes_more(bed); };
  while (at.now.phase != pack::Phase::insertion || more()) {
    if (at.now.phase == pack::Phase::relaxation) {
      relax(bed, attendant);
      at.now = {};
    } else {
      insert_and_settle(bed, attendant);
      at.now = {.phase = more() ? pack::Phase::insertion : pack::Phase::relaxation};
    }
    attendant.layer_ended();
  }
}

}  // namespace packmpi::run
