/// Where the lid and the moving sides are: what steers a run under [confinement], in checkpoints as it is.
#pragma once
#include <array>
#include <cstdint>

#include "geometry/container.hpp"

namespace packmpi::confine {

/// The same on all ranks. Speeds are those of Servo, outward positive.
struct State {
  bool on = false;                    ///< the lid is there
  double from = 0.0;                  ///< [m] height of the lid when it came
  double lid = 0.0, lid_speed = 0.0;  ///< [m] its height, [m/s]
  std::array<double, 2> size{};       ///< [m] lateral extents
  std::array<double, 2> speed{};      ///< [m/s] of them
  std::int64_t steps = 0;             ///< made under the lid
  double phi_before = 0.0;            ///< solid fraction of the bulk before it came
  bool full = false;                  ///< no layer fitted any more before it came
  double work = 0.0;                  ///< [J] that lid and sides have done on the particles
  bool over = false;                  ///< the stress is there and the pack at rest, or the time is up
};

/// The container with its lid and sides where they are. Local.
void apply(const State& state, geometry::Container& box);

}  // namespace packmpi::confine
