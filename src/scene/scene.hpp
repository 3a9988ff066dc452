/// What is packed: the input turned into the quantities the method needs. The same on every rank, O(1) in size.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/columns.hpp"
#include "geometry/container.hpp"
#include "input/input.hpp"
#include "scene/features.hpp"
#include "scene/sizes.hpp"

namespace packmpi::scene {

/// Coefficients of friction [-].
struct Friction {
  double particles = 0.0, walls = 0.0;   ///< sliding
  double rolling = 0.0, twisting = 0.0;  ///< resistance; friction with memory only
};

/// What the scene says of it. Local.
[[nodiscard]] constexpr Friction own_friction(const input::Contact& contact) noexcept {
  return {contact.friction, contact.wall_friction, contact.rolling_friction, contact.twisting_friction};
}

/// A periodic axis that [confinement] shortens gives up at most this share of its length.
inline constexpr double most_shortening = 0.1;

/// How particles are integrated for a while.
struct Stage {
  double time_step = 0.0;                 ///< [s]
  double youngs_modulus = 0.0;            ///< [Pa]
  std::optional<Friction> friction = {};  ///< none: the scene's own
};

/// The scene. `in` is what was asked; the rest is derived from it.
struct Scene {
  input::Input in;
  geometry::Container container;
  Features features;
  Sizes sizes;                         ///< the size distribution: radius of (layer, particle), bounds
  std::vector<Sizes> component_sizes;  ///< of each component; empty if there is one only
  double reach = 0.0;        ///< [m] largest distance at which two centres interact: 2 r_max, or the near-field cut-off
  double skin = 0.0;         ///< [m] what columns are wider than reach at least; does not change any result
  double most_margin = 0.0;  ///< [m] neighbour lists allow one particle to move at most so far; likewise
  double time_step = 0.0;    ///< [s] of the final stage, and of the layers unless they have their own
  Stage settling;            ///< of the layers
  double relaxation = 0.0;   ///< [s] duration of the final stage
  double wait = 0.0;         ///< [s] that it goes on at most until the bed is at rest
  double confining_step = 0.0;    ///< [s] under the stress of [confinement]; 0 without
  double force_quantum = 0.0;     ///< [N] a power of two: forces are summed as integers of this unit
  double speed_bound = 0.0;       ///< [m/s] no particle of a valid run is as fast
  std::int64_t most_columns = 1;  ///< of the lateral grid: memory for empty ground is bounded (doc/theory.md)

  /// Width the columns of the lateral grid need at least: reach + skin [m], and the gap of insertion.
  [[nodiscard]] double column_width() const noexcept { return reach + skin + in.layers.gap; }
  /// The lateral grid: columns of that width, or wider ones where there would be more than most_columns, or where a
  /// wide box has plenty: fast particles may then move farther before lists are made anew.
  [[nodiscard]] geometry::ColumnGrid columns() const;
  /// Two centres are in a neighbour list only if they are nearer than that [m]; columns are as wide at least.
  [[nodiscard]] double list_range() const noexcept { return reach + 2.0 * most_margin; }
  /// Periodic axes that [confinement] shortens begin with columns so much wider than they need to be [-].
  [[nodiscard]] double room() const noexcept {
    return in.confinement && in.confinement->on_sides() ? 1.0 / (1.0 - most_shortening) : 1.0;
  }
  /// The final stage, once it is hard.
  [[nodiscard]] Stage last() const noexcept { return {time_step, in.particles.youngs_modulus}; }
};

/// Derive the scene from the input. Local and pure. Throws Error(bad_input) on cross-checks that involve derived
/// quantities (time step beyond eq. (23), periodic axis below three columns).
[[nodiscard]] Scene build(const input::Input& in);

/// The limit of eq. (23) for the smallest particles, duration / 5 [s]. A step between this and the limit of the mean
/// particle is taken with a warning: the paper's own example 5.2 has one.
[[nodiscard]] double safe_time_step(const input::Input& in, const Sizes& sizes);

/// Steps of `time_step` [s] in `seconds`: the nearest number, at least one.
[[nodiscard]] std::int64_t steps_in(double seconds, double time_step);
/// From row to row of the step log, in a stage of that step [s].
[[nodiscard]] std::int64_t steps_a_row(const input::Output& output, double time_step);

}  // namespace packmpi::scene
