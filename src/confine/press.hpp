/// Presses a bed: its lid and sides step by step, and whether the stress asked for is there.
#pragma once
#include <cstdint>
#include <functional>

#include "comm/comm.hpp"
#include "confine/servo.hpp"
#include "confine/state.hpp"
#include "dynamics/law.hpp"
#include "neighbor/neighborhood.hpp"
#include "particles/store.hpp"
#include "scene/ownership.hpp"
#include "scene/scene.hpp"

namespace packmpi::confine {

/// The lid on top of a bed of that top [m], at rest. Local.
[[nodiscard]] State begin(const scene::Scene& scene, double top);

/// Whom a press asks, and tells.
struct Hooks {
  std::function<void()> step;                   ///< collective: a step of the bed, of scene.confining_step
  std::function<bool()> at_rest;                ///< collective: by the measures of [rest]
  std::function<void()> stop;                   ///< takes velocity and spin from every particle
  std::function<void(double share)> moment;     ///< collective: of output.log_every
  std::function<std::int64_t()> steps_to_look;  ///< at least 1, the same on all ranks
  std::function<void()> look;                   ///< collective; may end it by an Error
};

/// Moves lid and sides of a container that is `box`, and that of the scene. All it is given must outlive it.
class Press {
 public:
  /// Collective. `state` is applied to the box already.
  Press(const comm::Comm& comm, const scene::Scene& scene, geometry::Container& box, State& state,
        particles::Store& store, neighbor::Neighborhood& neighborhood, scene::Ownership& ownership);

  /// Collective. From where the state says until the stress is there within its tolerance and the bed at rest, both
  /// looked at after every ten crossings of a wave, or the time is up. Particles that move on though the stress is
  /// there, such as rattlers that spin, are stopped at such looks. What lid and sides do on the particles goes to
  /// State::work.
  void run(const Hooks& hooks);

 private:
  void move();
  void steer_walls();
  void steer_periods();
  void move_walls();
  void move_periods();
  [[nodiscard]] std::int64_t next_stop(std::int64_t to_look) const;

  const comm::Comm* comm_;
  const scene::Scene* scene_;
  geometry::Container* box_;
  State* state_;
  particles::Store* store_;
  neighbor::Neighborhood* neighborhood_;
  scene::Ownership* ownership_;
  dynamics::Law law_;
  Gains gains_;
  std::int64_t lid_tick_, side_tick_;
  bool periods_move_;
  std::int64_t window_, row_, most_;
  std::int64_t rebuilds_ = -1;  // the lists that travel_ is of
  double travel_ = 0.0;         // [m] of the lid or a side since then
};

}  // namespace packmpi::confine
