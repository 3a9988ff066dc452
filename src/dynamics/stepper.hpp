/// Dynamics of all particles, step after step: explicit (CC16 Algorithm 2, theta = 0), or implicit (theta > 0).
#pragma once
#include <cstdint>
#include <memory>

#include "comm/comm.hpp"
#include "dynamics/guard.hpp"
#include "dynamics/kernel.hpp"
#include "implicit/implicit.hpp"
#include "neighbor/neighborhood.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::dynamics {

/// A look at all overlaps costs about a step: so many steps lie between two, unless the largest force doubles.
inline constexpr std::int64_t rest_between_looks = 100;

/// What a rank has worked on since the beginning: numbers of a step, summed over the steps. Exact.
struct Work {
  std::int64_t particle_steps = 0;  ///< owned, moving
  std::int64_t frozen_steps = 0;    ///< owned, frozen: they cost nothing
  std::int64_t ghost_steps = 0;     ///< copies of other ranks' moving particles, refreshed
  std::int64_t pair_steps = 0;      ///< pairs of the contact list
};

/// Advances a store in time: kernel, then ghosts and lists. Holds the integer accumulators.
class Stepper {
 public:
  Stepper(const comm::Comm& comm, const scene::Scene& scene);

  /// From now on this time step and modulus; at first those of scene.last(). The forces of a modulus beyond the
  /// particles' are out of range. Local, but on every rank alike.
  void use(const scene::Stage& stage);

  /// Collective. `steps` steps from `start` on. On entry and on return lists and ghosts belong to the positions.
  /// Throws Error(numerical_failure) on all ranks (see report()): in the step of the first force out of range, speed
  /// that is not finite or beyond its limit; within rest_between_looks of an overlap beyond the deepest that grows;
  /// when lists are due, of a particle outside the container.
  void advance(particles::Store& store, neighbor::Neighborhood& neighborhood, std::int64_t steps,
               const Moment& start = {});

  /// Collective. Throws as advance() if any particle has any fault. Cost: about a step.
  void check(const particles::Store& store, const neighbor::Neighborhood& neighborhood, const Moment& now);

  [[nodiscard]] const Law& law() const noexcept { return law_; }  ///< of the stage in use
  /// Largest contact force and speed bound of the last step, this rank. [N], [m/s]
  [[nodiscard]] const StepReport& last() const noexcept { return last_; }
  [[nodiscard]] const Work& work() const noexcept { return work_; }  ///< this rank, so far
  /// Null if theta is 0.
  [[nodiscard]] const Implicit* implicit() const noexcept { return implicit_.get(); }
  [[nodiscard]] std::size_t bytes() const noexcept { return ring_.capacity() * sizeof(std::int64_t); }

 private:
  void advance_one(particles::Store& store, neighbor::Neighborhood& neighborhood);
  StepReport sweep(particles::Store& store, neighbor::Neighborhood& neighborhood);
  void fit_ring(const particles::Store& store, const neighbor::Neighborhood& neighborhood);
  [[nodiscard]] StepData data(particles::Store& store, neighbor::Neighborhood& neighborhood);
  void add_near_forces(const particles::Store& store, const neighbor::Neighborhood& neighborhood);
  [[nodiscard]] neighbor::Alarm alarm_of_step(const particles::Store& store) const;
  [[nodiscard]] Inspected inspected(const particles::Store& store, const neighbor::Neighborhood& neighborhood) const;

  const comm::Comm* comm_;
  const scene::Scene* scene_;
  Kernel kernel_ = nullptr;
  std::unique_ptr<Implicit> implicit_;
  scene::Stage stage_;
  Law law_{};
  double speed_limit_ = 0.0;     // [m/s]
  double pressing_force_ = 0.0;  // [N] beyond it, overlaps are looked at
  std::int64_t since_look_ = rest_between_looks;
  double looked_force_ = 0.0;       // [N] largest on any rank at the last look
  std::vector<std::int64_t> ring_;  // accumulators, with room to align
  std::int64_t* ring_begin_ = nullptr;
  std::int64_t ring_mask_ = 0;
  StepReport last_;
  bool near_in_range_ = true;
  Work work_;
};

}  // namespace packmpi::dynamics
