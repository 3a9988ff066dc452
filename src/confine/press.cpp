#include "confine/press.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/log.hpp"
#include "confine/outcome.hpp"
#include "confine/stress.hpp"
#include "observe/measure.hpp"

namespace packmpi::confine {
namespace {

// Waves cross the specimen so often between looks, and at most.
constexpr double crossings_a_window = 10.0, most_crossings = 1000.0;
// Lists are made for particles that move by half the skin, and walls by the other half.
constexpr double share_of_skin = 0.45;

}  // namespace

State begin(const scene::Scene& scene, double top) {
  State state{.on = true, .from = top, .lid = top};
  for (std::size_t a = 0; a < 2; ++a) state.size[a] = scene.container.size[a];
  if (scene.container.dimension == 2) state.size[1] = 0.0;
  return state;
}

Press::Press(const comm::Comm& comm, const scene::Scene& scene, geometry::Container& box, State& state,
             particles::Store& store, neighbor::Neighborhood& neighborhood, scene::Ownership& ownership)
    : comm_(&comm),
      scene_(&scene),
      box_(&box),
      state_(&state),
      store_(&store),
      neighborhood_(&neighborhood),
      ownership_(&ownership),
      law_(dynamics::make_law(scene, {scene.confining_step, scene.in.particles.youngs_modulus})),
      gains_(gains_of(scene, state.from, observe::motion(comm, store, scene).mass)),
      lid_tick_(lid_tick(scene, gains_)),
      side_tick_(side_tick(scene, gains_)),
      periods_move_(scene.in.confinement->on_sides().has_value() && scene.features.periodic),
      window_(scene::steps_in(crossings_a_window * gains_.crossing, scene.confining_step)),
      row_(scene::steps_a_row(scene.in.output, scene.confining_step)),
      most_(scene::steps_in(scene.in.confinement->wait.value_or(most_crossings * gains_.crossing),
                            scene.confining_step)) {}

// Lid, and lateral walls that move: by the forces on them.
void Press::steer_walls() {
  const input::Confinement& asked = *scene_->in.confinement;
  const double seconds = static_cast<double>(lid_tick_) * scene_->confining_step;
  const auto vertical = static_cast<std::size_t>(box_->vertical());
  const double mass = lid_mass(*scene_, gains_);
  const Vec3 stress = on_high_walls(*comm_, *store_, *scene_, law_, *neighborhood_);
  state_->lid_speed = next_speed(gains_, mass, state_->lid_speed, stress[vertical] - asked.on_lid(), seconds);
  state_->work -= stress[vertical] * area_across(*scene_, vertical) * state_->lid_speed * seconds;
  for (std::size_t a = 0; a < vertical && asked.on_sides(); ++a) {
    if (box_->periodic[a]) continue;
    state_->speed[a] = next_speed(gains_, mass, state_->speed[a], stress[a] - *asked.on_sides(), seconds);
    state_->work -= stress[a] * area_across(*scene_, a) * state_->speed[a] * seconds;
  }
}

// Periodic axes: by the stress of the contacts.
void Press::steer_periods() {
  const input::Confinement& asked = *scene_->in.confinement;
  const double seconds = static_cast<double>(side_tick_) * scene_->confining_step;
  const Vec3 stress = of_contacts(*comm_, *store_, *scene_, law_, *neighborhood_).contacts;
  for (std::size_t a = 0; a < static_cast<std::size_t>(box_->lateral_axes()); ++a) {
    if (!box_->periodic[a]) continue;
    const double excess = stress[a] - *asked.on_sides();
    state_->speed[a] = next_speed(gains_, side_mass(*scene_, gains_, a), state_->speed[a], excess, seconds);
    state_->work -= stress[a] * area_across(*scene_, a) * state_->speed[a] * seconds;
  }
}

// Lists are made anew when walls have moved far.
void Press::move_walls() {
  const double dt = scene_->confining_step;
  double fastest = std::abs(state_->lid_speed);
  state_->lid += state_->lid_speed * dt;
  for (std::size_t a = 0; a < static_cast<std::size_t>(box_->lateral_axes()); ++a) {
    if (box_->periodic[a]) continue;
    state_->size[a] += state_->speed[a] * dt;
    fastest = std::max(fastest, std::abs(state_->speed[a]));
  }
  apply(*state_, *box_);
  if (rebuilds_ != neighborhood_->rebuilds()) {
    rebuilds_ = neighborhood_->rebuilds();
    travel_ = 0.0;
  }
  travel_ += fastest * dt;
  if (travel_ >= share_of_skin * scene_->skin) neighborhood_->rebuild(*store_);
}

// The way of a whole tick at once: box, columns and particles together.
void Press::move_periods() {
  const double seconds = static_cast<double>(side_tick_) * scene_->confining_step;
  std::array<double, 2> factors{1.0, 1.0};
  for (std::size_t a = 0; a < static_cast<std::size_t>(box_->lateral_axes()); ++a) {
    if (!box_->periodic[a]) continue;
    const double before = state_->size[a], asked = scene_->in.container.size[a];
    state_->size[a] += state_->speed[a] * seconds;
    factors[a] = state_->size[a] / before;
    if (state_->size[a] >= (1.0 - scene::most_shortening) * asked) continue;
    comm::fail_together(*comm_, ExitCode::numerical_failure,
                        fmt::format("confinement: the periodic axis {} is shortened by more than {:g} of its length: "
                                    "the pack is too loose for its stress; use a denser pack, more friction, or less "
                                    "lateral stress",
                                    "xy"[a], scene::most_shortening));
  }
  apply(*state_, *box_);
  ownership_->stretch(*box_);
  neighborhood_->deform(*store_, factors);
}

// What comes before a step.
void Press::move() {
  if (periods_move_ && state_->steps % side_tick_ == 0) {
    steer_periods();
    move_periods();
  }
  if (state_->steps % lid_tick_ == 0) steer_walls();
  move_walls();
}

std::int64_t Press::next_stop(std::int64_t to_look) const {
  const std::int64_t now = state_->steps;
  return std::min({(now / window_ + 1) * window_, (now / row_ + 1) * row_, most_, now + to_look});
}

void Press::run(const Hooks& hooks) {
  State& now = *state_;
  while (!now.over) {
    for (const std::int64_t next = next_stop(hooks.steps_to_look()); now.steps < next; ++now.steps) {
      move();
      hooks.step();
    }
    now.over = now.steps >= most_;
    if (!now.over && now.steps % window_ == 0) {
      const Outcome got = measure(*comm_, *store_, *scene_, *neighborhood_, now);
      log::debug(
          fmt::format("step {} under the lid: height {:.6g} m, on it {:.4g} Pa, of contacts {:.4g} Pa, at rest "
                      "{:.4g} Pa",
                      now.steps, now.lid, got.on_lid, got.of_contacts.back(), got.vertical_at_rest));
      const bool there = got.worst() <= got.tolerance;
      now.over = there && hooks.at_rest();
      if (there && !now.over) hooks.stop();
    }
    if (now.steps % row_ == 0 || now.over) hooks.moment(static_cast<double>(now.steps) / static_cast<double>(most_));
    if (!now.over) hooks.look();
  }
}

}  // namespace packmpi::confine
