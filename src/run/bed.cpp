#include "run/bed.hpp"

#include <algorithm>
#include <array>

#include "base/log.hpp"
#include "base/timer.hpp"
#include "scene/mixture.hpp"

namespace packmpi::run {

Bed::Bed(const comm::Comm& world, const scene::Scene& what)
    : comm(world),
      scene(what),
      ownership(world, what.columns(), what.in.parallel.decomposition),
      store(what.features.layout()),
      neighborhood(world, what, ownership),
      stepper(world, what) {
  progress.mixing = control::begin_mixing(what);
}

void Bed::freeze_older() {
  const auto window = static_cast<std::size_t>(scene.in.dynamics.window);
  if (window == 0 || progress.first_ids.size() <= window) return;
  const GlobalId before = progress.moving_from;
  progress.moving_from = progress.first_ids[progress.first_ids.size() - window];
  progress.energy_given -= observe::energy_of(comm, store, scene, before, progress.moving_from);
  neighborhood.freeze(store, progress.moving_from);
}

void Bed::release() {
  if (progress.moving_from == 0) return;
  const GlobalId before = progress.moving_from;
  progress.moving_from = 0;
  neighborhood.release(store);
  progress.energy_given += observe::energy_of(comm, store, scene, 0, before);
}

void Bed::stop() {
  const particles::Layout& layout = store.layout();
  for (LocalIndex i = 0; i < store.total(); ++i) {
    double* record = store.record(i);
    std::fill_n(record + layout.velocity, layout.dimension, 0.0);
    if (layout.rotation) std::fill_n(record + layout.spin, layout.spin_components(), 0.0);
  }
}

void Bed::advance(std::int64_t steps) {
  const Stopwatch watch;
  stepper.advance(store, neighborhood, steps, moment());
  stepping += watch.seconds();
  progress.steps += steps;
  progress.particle_steps += steps * (progress.count - progress.moving_from);
}

double Bed::time() const {
  const std::int64_t of_layers = progress.steps - progress.relaxation_steps - progress.confined.steps;
  return static_cast<double>(of_layers) * scene.settling.time_step +
         static_cast<double>(progress.relaxation_steps) * scene.time_step +
         static_cast<double>(progress.confined.steps) * scene.confining_step;
}

dynamics::Moment Bed::moment() const { return {std::ssize(progress.first_ids), progress.steps, time()}; }

double Bed::top() const {
  return std::max(observe::top(comm, store, scene), observe::top(comm, neighborhood.frozen(), scene));
}

double Bed::surface() const {
  const std::array<const particles::Store*, 2> all{&store, &neighborhood.frozen()};
  return observe::surface_height(comm, all, scene);
}

double Bed::height() const { return scene.in.layers.height == input::HeightRule::highest ? top() : surface(); }

rsa::LayerRegion Bed::next_region() const {
  const double bottom = top() + (progress.count > 0 ? scene.in.layers.gap : 0.0), whole = scene.in.layers.thickness;
  const double left = scene.container.height() - bottom;
  const bool clipped = scene.in.layers.region == input::RegionRule::container && left < whole;
  return {.layer = static_cast<std::uint32_t>(progress.first_ids.size()),
          .bottom = bottom,
          .thickness = clipped ? left : whole,
          .first_id = progress.count,
          .clipped = clipped};
}

bool Bed::full() const {
  if (scene.in.layers.region == input::RegionRule::open) return false;
  return next_region().thickness < 2.0 * scene.sizes.largest();
}

observe::Bulk Bed::bulk() const { return observe::bulk_of(scene, surface()); }

double Bed::fraction_of(const control::Slab& slab) const {
  const observe::Bulk part{slab.low, slab.high};
  return observe::density(comm, store, scene, part).phi_bulk +
         observe::density(comm, neighborhood.frozen(), scene, part).phi_bulk;
}

void Bed::balance() {
  if (ownership.rebalance(neighborhood.column_counts(store))) {
    neighborhood.ownership_changed();
    log::debug("columns were shared out anew");
  }
  neighborhood.rebuild(store);
}

pack::HistoriesHere Bed::histories() const {
  const auto each = [this](const std::function<void(const pack::HistoryRow&)>& see) {
    neighborhood.each_history(store, [&](const neighbor::ContactHistory& contact) {
      const GlobalId holder = contact.holder();
      pack::HistoryRow row{.holder = holder, .other = contact.second < 0 ? contact.second : contact.first};
      std::ranges::copy(contact.values, row.values.begin());
      see(row);
    });
  };
  return {.features = scene.features, .each = each};
}

void Bed::give(const pack::Histories& histories) {
  const auto stored = static_cast<std::size_t>(scene::stored_doubles(scene.features));
  std::vector<neighbor::ContactHistory> contacts;
  contacts.reserve(histories.rows.size());
  for (const pack::HistoryRow& row : histories.rows) {
    const bool wall = row.other < 0;
    contacts.push_back({.first = wall ? row.holder : row.other,
                        .second = wall ? row.other : row.holder,
                        .values = std::span(row.values).first(stored)});
  }
  neighborhood.give(store, contacts);
}

std::vector<std::int32_t> Bed::layers() const {
  std::vector<std::int32_t> layer;
  layer.reserve(static_cast<std::size_t>(store.owned()));
  for (const GlobalId id : store.ids().first(static_cast<std::size_t>(store.owned()))) {
    layer.push_back(
        static_cast<std::int32_t>(std::ranges::upper_bound(progress.first_ids, id) - progress.first_ids.begin()) - 1);
  }
  return layer;
}

std::vector<std::int32_t> Bed::strata() const {
  if (scene.in.strata.empty()) return {};
  std::vector<std::int32_t> of = layers();
  for (std::int32_t& k : of) k = static_cast<std::int32_t>(progress.mixing.strata[static_cast<std::size_t>(k)]);
  return of;
}

void Bed::mark_components() {
  if (!scene.features.mixture) return;
  const std::vector<std::int32_t> layer = layers();
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const auto of = static_cast<std::size_t>(layer[at]);
    const int component = control::component_of(progress.mixing, of, progress.first_ids[of], store.ids()[at]);
    store.set_substance(i, scene::substance_of(scene.in, component, store.radius(i)));
  }
}

std::size_t Bed::bytes() const noexcept { return store.bytes() + neighborhood.bytes() + stepper.bytes(); }

double Bed::bytes_per_particle() const {
  return comm.max(static_cast<double>(bytes()) /
                  static_cast<double>(std::max<LocalIndex>(1, store.owned() + neighborhood.frozen().owned())));
}

}  // namespace packmpi::run
