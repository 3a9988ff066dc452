#include "dynamics/stepper.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynamics/near_field.hpp"

namespace packmpi::dynamics {
namespace {

constexpr std::size_t alignment = 64 / sizeof(std::int64_t);

Vec3 gravity_of(const scene::Scene& scene) {
  Vec3 g{};
  g[static_cast<std::size_t>(scene.container.vertical())] = -scene.in.jamming.gravity;
  return g;
}

// What a step does of a leg.
StepData part_of(StepData whole, const neighbor::Leg& before, const neighbor::Leg& leg) {
  whole.begin = before.end;
  whole.end = leg.end;
  whole.first += before.pairs_end;
  whole.second += before.pairs_end;
  whole.pairs = leg.pairs_end - before.pairs_end;
  whole.wall_particle += before.walls_end;
  whole.wall += before.walls_end;
  if (whole.facing != nullptr) whole.facing += before.walls_end;
  whole.walls = leg.walls_end - before.walls_end;
  if (whole.stored_pairs.values != nullptr) whole.stored_pairs.values += before.pairs_end;
  if (whole.stored_walls.values != nullptr) whole.stored_walls.values += before.walls_end;
  return whole;
}

}  // namespace

Stepper::Stepper(const comm::Comm& comm, const scene::Scene& scene) : comm_(&comm), scene_(&scene) {
  comm::agree_on(comm, [&] { kernel_ = select_kernel(scene.features); });  // PACKMPI_ARCH of one rank alone
  if (scene.in.dynamics.theta > 0.0) implicit_ = std::make_unique<Implicit>(comm, scene);
  use(scene.last());
}

void Stepper::use(const scene::Stage& stage) {
  stage_ = stage;
  law_ = make_law(*scene_, stage);
  speed_limit_ = speed_limit(*scene_, stage);
  const double r = scene_->sizes.smallest();  // the lightest contact there is: r* = r / 2
  const double overlap = deepest_overlap * r;
  pressing_force_ = law_.pair.stiffness * std::sqrt(0.5 * r * overlap) * overlap;
}

void Stepper::advance(particles::Store& store, neighbor::Neighborhood& neighborhood, std::int64_t steps,
                      const Moment& start) {
  for (std::int64_t step = 0; step < steps; ++step) {
    advance_one(store, neighborhood);
    work_.particle_steps += store.owned();
    work_.frozen_steps += neighborhood.frozen().owned();
    work_.ghost_steps += neighborhood.halo().ghosts();
    work_.pair_steps += std::ssize(neighborhood.pairs().first);
    ++since_look_;
    const neighbor::Alarm alarm = neighborhood.follow(store, last_.max_speed, stage_.time_step, alarm_of_step(store));
    if (alarm == neighbor::Alarm::none) continue;
    neighborhood.arrive(store);
    const Moment now{start.layer, start.step + step + 1, start.time + static_cast<double>(step + 1) * stage_.time_step};
    if (alarm == neighbor::Alarm::fault) report(inspected(store, neighborhood), now);
    check(store, neighborhood, now);
  }
  neighborhood.arrive(store);
}

void Stepper::check(const particles::Store& store, const neighbor::Neighborhood& neighborhood, const Moment& now) {
  const Finding found = inspect(inspected(store, neighborhood));
  std::array<double, 2> shared{static_cast<double>(found.fault), last_.max_force};
  comm_->max(shared);
  if (shared[0] > 0.0) report(inspected(store, neighborhood), now);
  since_look_ = 0;
  looked_force_ = shared[1];
}

// From what the kernel tells anyway. Its speed is a bound, so particles are looked at only beyond the limit. An overlap
// beyond the deepest while two close in gives a force beyond pressing_force_; so do valid impacts of large particles,
// so it is not looked again at once unless the force doubles.
neighbor::Alarm Stepper::alarm_of_step(const particles::Store& store) const {
  if (!last_.in_range || !near_in_range_) return neighbor::Alarm::fault;
  if (last_.max_speed > speed_limit_) {
    for (LocalIndex i = 0; i < store.owned(); ++i) {
      const Vec3 v = store.velocity(i);
      if (std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) > speed_limit_) return neighbor::Alarm::fault;
    }
  }
  const bool news = since_look_ >= rest_between_looks || last_.max_force > 2.0 * looked_force_;
  return last_.max_force > pressing_force_ && news ? neighbor::Alarm::look : neighbor::Alarm::none;
}

Inspected Stepper::inspected(const particles::Store& store, const neighbor::Neighborhood& neighborhood) const {
  return {*comm_, *scene_, store, neighborhood, stage_};
}

void Stepper::advance_one(particles::Store& store, neighbor::Neighborhood& neighborhood) {
  if (implicit_) {
    neighborhood.arrive(store);
    const Implicit::Outcome done = implicit_->step(law_, store, neighborhood, stage_.time_step);
    last_ = {.max_speed = done.max_speed, .max_force = done.max_force};
    return;
  }
  fit_ring(store, neighborhood);
  if (scene_->features.near_field) {
    neighborhood.arrive(store);
    add_near_forces(store, neighborhood);
  }
  last_ = sweep(store, neighborhood);
}

// Ghosts travel meanwhile: those of the first half from the middle of a step to the next step's beginning, those of the
// second from its end to the next one's middle, through the reduction (Neighborhood::follow).
StepReport Stepper::sweep(particles::Store& store, neighbor::Neighborhood& neighborhood) {
  const StepData whole = data(store, neighborhood);
  StepReport report;
  neighbor::Leg done{};
  for (const neighbor::Leg& leg : neighborhood.sweep()) {
    for (const neighbor::Half half : neighbor::halves) {
      if (leg.needs[static_cast<std::size_t>(half)]) neighborhood.end_refresh(half, store);
    }
    report = together(report, kernel_(part_of(whole, done, leg)));
    for (const neighbor::Half half : neighbor::halves) {
      if (leg.sends[static_cast<std::size_t>(half)]) neighborhood.begin_refresh(half, store);
    }
    done = leg;
  }
  return report;
}

// The ring holds the window of the half list; with a near field, whose forces come first, it holds every particle.
void Stepper::fit_ring(const particles::Store& store, const neighbor::Neighborhood& neighborhood) {
  const LocalIndex needed = scene_->features.near_field ? store.owned() : neighborhood.pairs().window;
  const std::int64_t slots = ring_slots(needed);
  if (slots <= ring_mask_ + 1 && ring_begin_ != nullptr) return;
  const auto each = static_cast<std::size_t>(accumulators_of(store.layout()));
  ring_.assign((static_cast<std::size_t>(slots) + 1) * each + alignment, 0);
  const auto address = reinterpret_cast<std::uintptr_t>(ring_.data());
  ring_begin_ = ring_.data() + (64 - address % 64) % 64 / sizeof(std::int64_t);
  ring_mask_ = slots - 1;
}

StepData Stepper::data(particles::Store& store, neighbor::Neighborhood& neighborhood) {
  const neighbor::PairList& pairs = neighborhood.pairs();
  const neighbor::WallList& walls = neighborhood.walls();
  return StepData{
      .records = store.records(),
      .owned = store.owned(),
      .begin = 0,
      .end = store.owned(),
      .first = pairs.first.data(),
      .second = pairs.second.data(),
      .pairs = static_cast<std::int64_t>(pairs.first.size()),
      .wall_particle = walls.particle.data(),
      .wall = walls.wall.data(),
      .walls = static_cast<std::int64_t>(walls.particle.size()),
      .ring = ring_begin_,
      .ring_mask = ring_mask_,
      .law = law_,
      .force_quantum = scene_->force_quantum,
      .time_step = stage_.time_step,
      .gravity = gravity_of(*scene_),
      .drag = scene_->in.drag.coefficient,
      .fluid_velocity = scene_->in.drag.fluid_velocity,
      .size = scene_->container.size,
      .periodic = scene_->container.periodic,
      .planes = planes_of(scene_->container),
      .round = round_of(scene_->container),
      .facing = walls.facing.empty() ? nullptr : walls.facing.data(),
      .stored_pairs = {neighborhood.memory().of_pairs(), std::ssize(pairs.first)},
      .stored_walls = {neighborhood.memory().of_walls(), std::ssize(walls.particle)},
  };
}

void Stepper::add_near_forces(const particles::Store& store, const neighbor::Neighborhood& neighborhood) {
  near_in_range_ = add_near_field(*scene_, store, neighborhood.near_pairs(), ring_begin_);
}

}  // namespace packmpi::dynamics
