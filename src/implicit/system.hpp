/// The nonlinear system of one implicit step (CC16 eqs. 16-21): unknown velocities and spins, its residual and
/// Jacobian.
#pragma once
#include <petscmat.h>

#include <vector>

#include "comm/comm.hpp"
#include "law/law.hpp"
#include "neighbor/neighborhood.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::dynamics {

/// For every owned particle the unknowns are v [m/s] and r omega [m/s] at t + dt, `unknowns()` numbers in slot order:
///   x(t+dt) = x(t) + dt (theta v(t+dt) + (1 - theta) v(t))
///   R = v(t+dt) - v(t) - dt (theta a(t+dt) + (1 - theta) a(t)) = 0,     the same for r omega.
/// The store holds the trial state while the system is being solved. The lists must hold for all trial positions.
class ImplicitSystem {
 public:
  /// Collective. For the present lists of `neighborhood`: make another one after a rebuild.
  ImplicitSystem(const comm::Comm& comm, const scene::Scene& scene, particles::Store& store,
                 neighbor::Neighborhood& neighborhood);

  [[nodiscard]] int unknowns() const noexcept { return store_.layout().dimension + store_.layout().spin_components(); }
  [[nodiscard]] LocalIndex owned() const noexcept { return store_.owned(); }

  /// Local. The state of the store is that at t; a step of `time_step` [s] by `law` begins. Writes the first guess, the
  /// velocities at t, to `u` [owned() * unknowns()].
  void begin(const Law& law, double time_step, double* u);
  /// Collective. The store takes the trial velocities `u` and the positions that follow; ghosts too.
  void set(const double* u);
  /// Collective. Sets `u` and writes its R [m/s], as long as u.
  void residual(const double* u, double* r);
  /// Collective. A zero matrix with room for the Jacobian, blocks of unknowns(); the caller destroys it.
  [[nodiscard]] Mat make_matrix() const;
  /// Collective. dR/du of the state set last.
  void jacobian(Mat matrix) const;
  /// Collective. The store is again at t.
  void restore();
  /// Local. The step is done: positions on periodic axes come back into the box.
  void accept();

  /// Local, of the last residual. Largest |x(t+dt) - x(t)| / dt [m/s]; largest normal force [N], NaN if one is not
  /// finite.
  [[nodiscard]] double largest_speed() const;
  [[nodiscard]] double largest_force() const noexcept { return largest_force_; }

 private:
  void accelerations(std::vector<double>& a);

  const comm::Comm& comm_;
  const scene::Scene& scene_;
  particles::Store& store_;
  neighbor::Neighborhood& neighborhood_;
  Law law_{};
  double time_step_ = 0.0;  // [s]
  double theta_;
  std::vector<double> before_;        // records of the owned at t
  std::vector<double> a_before_, a_;  // d u / dt at t and of the trial state
  std::vector<std::int64_t> row_;     // block row of every slot in the matrix; -1: no unknown (it stands still)
  double largest_force_ = 0.0;
};

}  // namespace packmpi::dynamics
