/// Explicit dynamics of all particles, step after step (CC16 Algorithm 2, theta = 0).
#pragma once
#include <cstdint>

#include "comm/comm.hpp"
#include "dynamics/kernel.hpp"
#include "neighbor/neighborhood.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::dynamics {

/// Advances a store in time: kernel, then ghosts and lists. Holds the integer accumulators.
class Stepper {
 public:
  Stepper(const comm::Comm& comm, const scene::Scene& scene);

  /// From now on this time step and modulus; at first those of scene.last(). The forces of a modulus beyond the
  /// particles' are out of range. Local, but on every rank alike.
  void use(const scene::Stage& stage);

  /// Collective. `steps` steps. On entry and on return lists and ghosts belong to the positions.
  /// Throws Error(numerical_failure) on all ranks, within a step of the first force out of range or non-finite speed,
  /// with the particle and what to change.
  void advance(particles::Store& store, neighbor::Neighborhood& neighborhood, std::int64_t steps);

  /// Largest contact force and speed bound of the last step, this rank. [N], [m/s]
  [[nodiscard]] const StepReport& last() const noexcept { return last_; }
  [[nodiscard]] std::int64_t particle_steps() const noexcept { return particle_steps_; }  ///< this rank, so far
  [[nodiscard]] std::size_t bytes() const noexcept { return ring_.capacity() * sizeof(std::int64_t); }

 private:
  void fit_ring(const particles::Store& store, const neighbor::Neighborhood& neighborhood);
  [[nodiscard]] StepData data(particles::Store& store, const neighbor::Neighborhood& neighborhood);
  void add_near_forces(const particles::Store& store, const neighbor::Neighborhood& neighborhood);
  [[noreturn]] void fail(const particles::Store& store, std::int64_t step) const;  // collective

  const comm::Comm* comm_;
  const scene::Scene* scene_;
  Kernel kernel_;
  double time_step_;  // [s]
  Law law_;
  std::vector<std::int64_t> ring_;  // accumulators, with room to align
  std::int64_t* ring_begin_ = nullptr;
  std::int64_t ring_mask_ = 0;
  StepReport last_;
  bool near_in_range_ = true;
  std::int64_t particle_steps_ = 0;
};

}  // namespace packmpi::dynamics
