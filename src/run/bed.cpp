#include "run/bed.hpp"

#include <algorithm>
#include <array>

#include "base/log.hpp"
#include "observe/measure.hpp"

namespace packmpi::run {

Bed::Bed(const comm::Comm& world, const scene::Scene& what)
    : comm(world),
      scene(what),
      ownership(world, what.columns(), what.in.parallel.decomposition),
      store(what.features.layout()),
      neighborhood(world, what, ownership),
      stepper(world, what) {}

void Bed::freeze_older() {
  const auto window = static_cast<std::size_t>(scene.in.dynamics.window);
  if (window == 0 || first_ids.size() <= window) return;
  const GlobalId before = moving_from;
  moving_from = first_ids[first_ids.size() - window];
  energy_given -= observe::energy_of(comm, store, scene, before, moving_from);
  neighborhood.freeze(store, moving_from);
}

void Bed::release() {
  if (moving_from == 0) return;
  const GlobalId before = moving_from;
  moving_from = 0;
  neighborhood.release(store);
  energy_given += observe::energy_of(comm, store, scene, 0, before);
}

double Bed::time() const {
  return static_cast<double>(steps - relaxation_steps) * scene.settling.time_step +
         static_cast<double>(relaxation_steps) * scene.time_step;
}

dynamics::Moment Bed::moment() const { return {std::ssize(first_ids), steps, time()}; }

double Bed::top() const {
  return std::max(observe::top(comm, store, scene), observe::top(comm, neighborhood.frozen(), scene));
}

double Bed::height() const {
  if (scene.in.layers.height == input::HeightRule::highest) return top();
  const std::array<const particles::Store*, 2> all{&store, &neighborhood.frozen()};
  return observe::surface_height(comm, all, scene);
}

void Bed::balance() {
  if (ownership.rebalance(neighborhood.column_counts(store))) {
    neighborhood.ownership_changed();
    log::debug("columns were shared out anew");
  }
  neighborhood.rebuild(store);
}

std::int64_t Bed::particle_steps() const { return earlier_particle_steps + comm.sum(stepper.work().particle_steps); }

std::vector<std::int32_t> Bed::layers() const {
  std::vector<std::int32_t> layer;
  layer.reserve(static_cast<std::size_t>(store.owned()));
  for (const GlobalId id : store.ids().first(static_cast<std::size_t>(store.owned()))) {
    layer.push_back(static_cast<std::int32_t>(std::ranges::upper_bound(first_ids, id) - first_ids.begin()) - 1);
  }
  return layer;
}

std::size_t Bed::bytes() const noexcept { return store.bytes() + neighborhood.bytes() + stepper.bytes(); }

double Bed::bytes_per_particle() const {
  return comm.max(static_cast<double>(bytes()) /
                  static_cast<double>(std::max<LocalIndex>(1, store.owned() + neighborhood.frozen().owned())));
}

}  // namespace packmpi::run
