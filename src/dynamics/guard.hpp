/// What no valid run shows (doc/theory.md, "Guards"): how it is found, and the one message about it.
#pragma once
#include <cstdint>
#include <string>

#include "comm/comm.hpp"
#include "neighbor/neighborhood.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::dynamics {

/// Where a run is, for messages.
struct Moment {
  std::int64_t layer = 0;  ///< that settles, from 1
  std::int64_t step = 0;   ///< since the beginning of the run
  double time = 0.0;       ///< [s] simulated
};

/// Faults, in order of gravity: the message names the worst particle of the gravest.
enum class Fault : std::int64_t { none, overlap, speed, force, outside, not_finite };

/// A particle with a fault on this rank.
struct Finding {
  Fault fault = Fault::none;
  double size = 0.0;     ///< overlap: of the smaller radius, or penetration of a wall; speed, force: its speed [m/s]
  LocalIndex slot = -1;  ///< owned
};

/// What is looked at.
struct Inspected {
  const comm::Comm& comm;
  const scene::Scene& scene;
  const particles::Store& store;
  const neighbor::Neighborhood& neighborhood;  ///< its lists and ghosts belong to the positions
  scene::Stage stage;                          ///< time step and modulus now
};

/// An overlap of two particles of so much of the smaller radius, or as deep a penetration of a wall, is beyond what the
/// contact law is for.
inline constexpr double deepest_overlap = 0.5;

/// Fastest valid motion in this stage [m/s]: the scene's bound, and half a smallest radius a step.
[[nodiscard]] double speed_limit(const scene::Scene& scene, const scene::Stage& stage);

/// The worst owned particle by the gravest fault; equals: the smallest id. Local. Cost: O(owned + pairs), about a step.
[[nodiscard]] Finding inspect(const Inspected& now);

/// Collective. Throws Error(numerical_failure) on all ranks, with the same words: what is wrong with which particle,
/// where, when, what touches it, and a time step or modulus to try. If no rank finds anything, it was a force out of
/// range; then the fastest particle is named.
[[noreturn]] void report(const Inspected& now, const Moment& moment);

}  // namespace packmpi::dynamics
