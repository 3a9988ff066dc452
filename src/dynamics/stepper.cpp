#include "dynamics/stepper.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "dynamics/near_field.hpp"

namespace packmpi::dynamics {
namespace {

constexpr std::size_t alignment = 64 / sizeof(std::int64_t);

Vec3 gravity_of(const scene::Scene& scene) {
  Vec3 g{};
  g[static_cast<std::size_t>(scene.box.vertical())] = -scene.in.jamming.gravity;
  return g;
}

}  // namespace

Stepper::Stepper(const comm::Comm& comm, const scene::Scene& scene)
    : comm_(&comm),
      scene_(&scene),
      kernel_(select_kernel(scene.features)),
      time_step_(scene.time_step),
      law_(make_law(scene)) {}

void Stepper::use(const scene::Stage& stage) {
  time_step_ = stage.time_step;
  law_ = make_law(*scene_, stage);
}

void Stepper::advance(particles::Store& store, neighbor::Neighborhood& neighborhood, std::int64_t steps) {
  for (std::int64_t step = 0; step < steps; ++step) {
    fit_ring(store, neighborhood);
    if (scene_->features.near_field) add_near_forces(store, neighborhood);
    last_ = kernel_(data(store, neighborhood));
    particle_steps_ += store.owned();
    const bool failed = !last_.in_range || !near_in_range_;
    if (neighborhood.follow(store, last_.max_speed, time_step_, failed)) fail(store, step);
  }
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

StepData Stepper::data(particles::Store& store, const neighbor::Neighborhood& neighborhood) {
  const neighbor::PairList& pairs = neighborhood.pairs();
  const neighbor::WallList& walls = neighborhood.walls();
  return StepData{
      .records = store.records(),
      .owned = store.owned(),
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
      .time_step = time_step_,
      .gravity = gravity_of(*scene_),
      .drag = scene_->in.drag.coefficient,
      .fluid_velocity = scene_->in.drag.fluid_velocity,
      .size = scene_->box.size,
      .periodic = scene_->box.periodic,
  };
}

void Stepper::add_near_forces(const particles::Store& store, const neighbor::Neighborhood& neighborhood) {
  near_in_range_ = add_near_field(*scene_, store, neighborhood.near_pairs(), ring_begin_);
}

// Names the worst particle of the lowest rank that has one: not finite first, else the fastest.
void Stepper::fail(const particles::Store& store, std::int64_t step) const {
  LocalIndex worst = 0;
  double fastest = -1.0;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const Vec3 v = store.velocity(i);
    const double speed = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    if (!std::isfinite(speed)) {
      worst = i;
      fastest = HUGE_VAL;
      break;
    }
    if (speed > fastest) worst = i, fastest = speed;
  }
  const double most = comm_->max(fastest);
  std::optional<std::string> complaint;
  if (fastest == most && store.owned() > 0) {
    const Vec3 x = store.position(worst);
    const Vec3 v = store.velocity(worst);
    complaint = fmt::format(
        "numbers blew up: a force beyond {:.3g} N or a speed that is not finite, {} steps after the last "
        "output; worst particle {} at ({:g}, {:g}, {:g}) m, velocity ({:g}, {:g}, {:g}) m/s, on rank {}; "
        "use a smaller dynamics.time_step or softer particles",
        max_quanta * scene_->force_quantum, step, store.ids()[static_cast<std::size_t>(worst)], x[0], x[1], x[2], v[0],
        v[1], v[2], comm_->rank());
  }
  comm::agree(*comm_, ExitCode::numerical_failure, complaint);
  throw Error(ExitCode::numerical_failure, "numbers blew up");
}

}  // namespace packmpi::dynamics
