/// Implicit members of the theta family (CC16 eqs. 16-21): the coupled system of all particles, by Newton's method.
#pragma once
#include <memory>

#include "comm/comm.hpp"
#include "law/law.hpp"
#include "neighbor/neighborhood.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::dynamics {

/// Steps with theta = 0.5 (second order) to 1 (first order, the most damped). PETSc's SNES solves each step: Newton
/// with line search, the Jacobian assembled with exact derivatives, GMRES preconditioned by ILU(0) of each rank's part;
/// options by [petsc] options = "-implicit_snes_..., -implicit_ksp_...".
/// GMRES adds in floating point over the ranks: packs agree between rank counts to the tolerance, not to the bit.
class Implicit {
 public:
  Implicit(const comm::Comm& comm, const scene::Scene& scene);
  ~Implicit();

  /// What a step tells.
  struct Outcome {
    double max_speed = 0.0;  ///< [m/s]
    double max_force = 0.0;  ///< [N] the largest normal force of a contact
  };

  /// Collective. One step of `time_step` [s]; lists and ghosts belong to the positions on entry, ghosts on return (call
  /// Neighborhood::follow() next). A step in which Newton's method fails, or a particle moves beyond the lists, is
  /// halved, up to most_halvings times, and the log says so. Throws Error(numerical_failure) on all ranks beyond that.
  Outcome step(const Law& law, particles::Store& store, neighbor::Neighborhood& neighborhood, double time_step);

  static constexpr int most_halvings = 12;

  /// What it took, so far; the same on every rank.
  struct Counters {
    std::int64_t newton_iterations = 0;
    std::int64_t linear_iterations = 0;
    std::int64_t residuals = 0;
    std::int64_t halvings = 0;
  };
  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }

 private:
  struct Solver;  // SNES, its vectors and matrix, for the present lists
  [[nodiscard]] bool try_step(const Law& law, particles::Store& store, neighbor::Neighborhood& neighborhood,
                              double time_step, Outcome& outcome);
  void make_solver(particles::Store& store, neighbor::Neighborhood& neighborhood);

  const comm::Comm* comm_;
  const scene::Scene* scene_;
  std::unique_ptr<Solver> solver_;
  std::int64_t rebuild_ = -1;  // the lists that solver_ is for
  double drift_ = 0.0;         // [m] bound of any displacement since then, all ranks
  Counters counters_;
};

}  // namespace packmpi::dynamics
