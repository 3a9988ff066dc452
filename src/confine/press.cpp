#include "confine/press.hpp"

#include <fmt/core.h>

#include <algorithm>
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

std::int64_t steps_in(double seconds, double time_step) {
  return std::max<std::int64_t>(1, std::llround(seconds / time_step));
}

}  // namespace

State begin(const scene::Scene& scene, double top) {
  State state{.on = true, .from = top, .lid = top};
  for (std::size_t a = 0; a < 2; ++a) state.size[a] = scene.container.size[a];
  if (scene.container.dimension == 2) state.size[1] = 0.0;
  return state;
}

Press::Press(const comm::Comm& comm, const scene::Scene& scene, geometry::Container& box, State& state,
             particles::Store& store, neighbor::Neighborhood& neighborhood)
    : comm_(&comm),
      scene_(&scene),
      box_(&box),
      state_(&state),
      store_(&store),
      neighborhood_(&neighborhood),
      law_(dynamics::make_law(scene, {scene.confining_step, scene.in.particles.youngs_modulus})),
      gains_(gains_of(scene, state.from, observe::motion(comm, store, scene).mass)),
      lid_tick_(lid_tick(scene, gains_)),
      side_tick_(side_tick(scene, gains_)),
      window_(steps_in(crossings_a_window * gains_.crossing, scene.confining_step)),
      row_(steps_in(scene.in.output.log_every, scene.confining_step)),
      most_(steps_in(scene.in.confinement->wait.value_or(most_crossings * gains_.crossing), scene.confining_step)) {}

void Press::steer_lid() {
  const double stress = on_lid(*comm_, *store_, *scene_, law_, *neighborhood_);
  const double seconds = static_cast<double>(lid_tick_) * scene_->confining_step;
  const double excess = stress - scene_->in.confinement->on_lid();
  state_->lid_speed = next_speed(gains_, lid_mass(*scene_, gains_), state_->lid_speed, excess, seconds);
  const auto vertical = static_cast<std::size_t>(box_->vertical());
  state_->work -= stress * area_across(*scene_, vertical) * state_->lid_speed * seconds;
}

// What comes before a step: the servo, when it is its turn, and the motion; lists are made anew when it was far.
void Press::move() {
  if (state_->steps % lid_tick_ == 0) steer_lid();
  const double step = state_->lid_speed * scene_->confining_step;
  state_->lid += step;
  apply(*state_, *box_);
  if (rebuilds_ != neighborhood_->rebuilds()) {
    rebuilds_ = neighborhood_->rebuilds();
    travel_ = 0.0;
  }
  travel_ += std::abs(step);
  if (travel_ >= share_of_skin * scene_->skin) neighborhood_->rebuild(*store_);
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
      now.over = got.worst() <= got.tolerance && hooks.at_rest();
    }
    if (now.steps % row_ == 0 || now.over) hooks.moment(static_cast<double>(now.steps) / static_cast<double>(most_));
    if (!now.over) hooks.look();
  }
}

}  // namespace packmpi::confine
