#include "run/pile.hpp"

#include <algorithm>
#include <array>

#include "base/log.hpp"
#include "observe/measure.hpp"

namespace packmpi::run {

Pile::Pile(const comm::Comm& world, const scene::Scene& what)
    : comm(world),
      scene(what),
      ownership(world, what.columns(), what.in.parallel.decomposition),
      store(what.features.layout()),
      neighborhood(world, what, ownership),
      stepper(world, what) {}

void Pile::freeze_older() {
  const auto window = static_cast<std::size_t>(scene.in.dynamics.window);
  if (window == 0 || first_ids.size() <= window) return;
  const GlobalId before = moving_from;
  moving_from = first_ids[first_ids.size() - window];
  energy_given -= observe::energy_of(comm, store, scene, before, moving_from);
  neighborhood.freeze(store, moving_from);
}

void Pile::thaw() {
  if (moving_from == 0) return;
  const GlobalId before = moving_from;
  moving_from = 0;
  neighborhood.thaw(store);
  energy_given += observe::energy_of(comm, store, scene, 0, before);
}

double Pile::time() const {
  return static_cast<double>(steps - thaw_steps) * scene.settling.time_step +
         static_cast<double>(thaw_steps) * scene.time_step;
}

dynamics::Moment Pile::moment() const { return {std::ssize(first_ids), steps, time()}; }

double Pile::top() const {
  return std::max(observe::top(comm, store, scene), observe::top(comm, neighborhood.frozen(), scene));
}

double Pile::height() const {
  if (scene.in.layers.height == input::HeightRule::highest) return top();
  const std::array<const particles::Store*, 2> all{&store, &neighborhood.frozen()};
  return observe::surface_height(comm, all, scene);
}

void Pile::balance() {
  if (ownership.rebalance(neighborhood.column_counts(store))) {
    neighborhood.ownership_changed();
    log::debug("columns were shared out anew");
  }
  neighborhood.rebuild(store);
}

std::int64_t Pile::particle_steps() const { return earlier_particle_steps + comm.sum(stepper.work().particle_steps); }

std::vector<std::int32_t> Pile::layers() const {
  std::vector<std::int32_t> layer;
  layer.reserve(static_cast<std::size_t>(store.owned()));
  for (const GlobalId id : store.ids().first(static_cast<std::size_t>(store.owned()))) {
    layer.push_back(static_cast<std::int32_t>(std::ranges::upper_bound(first_ids, id) - first_ids.begin()) - 1);
  }
  return layer;
}

std::size_t Pile::bytes() const noexcept { return store.bytes() + neighborhood.bytes() + stepper.bytes(); }

double Pile::bytes_per_particle() const {
  return comm.max(static_cast<double>(bytes()) /
                  static_cast<double>(std::max<LocalIndex>(1, store.owned() + neighborhood.frozen().owned())));
}

}  // namespace packmpi::run
