#include "implicit/implicit.hpp"

#include <fmt/core.h>
#include <petscsnes.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/log.hpp"
#include "implicit/petsc_check.hpp"
#include "implicit/system.hpp"

namespace packmpi::dynamics {
namespace {

// Newton's method ends when the residual, a velocity, has fallen by the one, or below the other times g dt.
constexpr double relative_tolerance = 1e-8;
constexpr double absolute_tolerance = 1e-7;
constexpr int most_iterations = 40;
// Halvings that the log tells one by one; the counters tell all.
constexpr std::int64_t told_halvings = 10;

// PETSc is C: no exception may pass through it.
template <class Action>
PetscErrorCode guarded(Vec u, Action&& action) {
  try {
    const double* trial = nullptr;
    check_petsc(VecGetArrayRead(u, &trial));
    action(trial);
    check_petsc(VecRestoreArrayRead(u, &trial));
  } catch (const std::exception& error) {
    log::error(error.what());
    return PETSC_ERR_LIB;
  }
  return 0;
}

PetscErrorCode evaluate_residual(SNES, Vec u, Vec r, void* system) {
  return guarded(u, [&](const double* trial) {
    double* out = nullptr;
    check_petsc(VecGetArray(r, &out));
    static_cast<ImplicitSystem*>(system)->residual(trial, out);
    check_petsc(VecRestoreArray(r, &out));
  });
}

PetscErrorCode evaluate_jacobian(SNES, Vec u, Mat jacobian, Mat, void* system) {
  return guarded(u, [&](const double* trial) {
    static_cast<ImplicitSystem*>(system)->set(trial);
    static_cast<ImplicitSystem*>(system)->jacobian(jacobian);
  });
}

}  // namespace

struct Implicit::Solver {
  ImplicitSystem system;
  Vec u = nullptr, r = nullptr;
  Mat matrix = nullptr;
  SNES snes = nullptr;

  Solver(const comm::Comm& comm, const scene::Scene& scene, particles::Store& store,
         neighbor::Neighborhood& neighborhood)
      : system(comm, scene, store, neighborhood), matrix(system.make_matrix()) {
    check_petsc(MatCreateVecs(matrix, &u, &r));
    check_petsc(SNESCreate(comm.handle(), &snes));
    check_petsc(SNESSetOptionsPrefix(snes, "implicit_"));
    check_petsc(SNESSetFunction(snes, r, evaluate_residual, &system));
    check_petsc(SNESSetJacobian(snes, matrix, matrix, evaluate_jacobian, &system));
    KSP ksp = nullptr;
    PC pc = nullptr;
    check_petsc(SNESGetKSP(snes, &ksp));
    check_petsc(KSPSetType(ksp, KSPGMRES));
    check_petsc(KSPSetTolerances(ksp, 1e-5, PETSC_DEFAULT, PETSC_DEFAULT, 300));
    check_petsc(KSPGetPC(ksp, &pc));
    check_petsc(PCSetType(pc, comm.size() > 1 ? PCBJACOBI : PCILU));
    check_petsc(SNESSetFromOptions(snes));
  }
  ~Solver() {
    SNESDestroy(&snes);
    MatDestroy(&matrix);
    VecDestroy(&u);
    VecDestroy(&r);
  }
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  void begin(const Law& law, double time_step, double absolute) {
    double* first_guess = nullptr;
    check_petsc(VecGetArray(u, &first_guess));
    system.begin(law, time_step, first_guess);
    check_petsc(VecRestoreArray(u, &first_guess));
    check_petsc(SNESSetTolerances(snes, absolute, relative_tolerance, 0.0, most_iterations, 100 * most_iterations));
  }

  // True if the system is solved; the store then holds the solution.
  bool solve(Counters& counters) {
    check_petsc(SNESSolve(snes, nullptr, u));
    SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
    PetscInt newton = 0, linear = 0, residuals = 0;
    check_petsc(SNESGetConvergedReason(snes, &reason));
    check_petsc(SNESGetIterationNumber(snes, &newton));
    check_petsc(SNESGetLinearSolveIterations(snes, &linear));
    check_petsc(SNESGetNumberFunctionEvals(snes, &residuals));
    counters.newton_iterations += newton;
    counters.linear_iterations += linear;
    counters.residuals += residuals;
    if (reason <= 0) return false;
    const double* solution = nullptr;
    check_petsc(VecGetArrayRead(u, &solution));
    system.set(solution);
    check_petsc(VecRestoreArrayRead(u, &solution));
    return true;
  }
};

Implicit::Implicit(const comm::Comm& comm, const scene::Scene& scene) : comm_(&comm), scene_(&scene) {}
Implicit::~Implicit() = default;

Implicit::Outcome Implicit::step(const Law& law, particles::Store& store, neighbor::Neighborhood& neighborhood,
                                 double time_step) {
  Outcome outcome;
  double left = 1.0;   // of the step
  double share = 1.0;  // of it tried at once: 2^-halvings
  int halvings = 0;
  while (left > 0.0) {
    Outcome part;
    if (try_step(law, store, neighborhood, share * time_step, part)) {
      left -= share;
      outcome.max_speed = std::max(outcome.max_speed, part.max_speed);
      outcome.max_force = part.max_force;
      continue;
    }
    if (++halvings > most_halvings) {
      comm::fail_together(
          *comm_, ExitCode::numerical_failure,
          fmt::format("the implicit step of {:g} s was not solved, not even {} of it; use a smaller "
                      "dynamics.time_step or contact.regularisation = \"viscous\" with a longer slip_time",
                      time_step, share));
    }
    share *= 0.5;
    if (++counters_.halvings <= told_halvings && comm_->rank() == 0) {
      log::warn(fmt::format("an implicit step was not solved; goes on with {:g} s", share * time_step));
    }
  }
  return outcome;
}

// False if the step must be shorter; the store is then as it was.
bool Implicit::try_step(const Law& law, particles::Store& store, neighbor::Neighborhood& neighborhood, double time_step,
                        Outcome& outcome) {
  const double room = 0.5 * scene_->skin;
  if (neighborhood.rebuilds() != rebuild_) make_solver(store, neighborhood);
  const double scale = std::max(scene_->in.jamming.gravity * time_step, 1e-9);
  const double unknowns = static_cast<double>(comm_->sum(std::int64_t{store.owned()})) * solver_->system.unknowns();
  solver_->begin(law, time_step, absolute_tolerance * scale * std::sqrt(unknowns));
  const bool solved = solver_->solve(counters_);
  const double speed = solver_->system.largest_speed();
  const double moved = comm_->max(speed * time_step);
  if (!solved || !(drift_ + moved <= room)) {  // NaN, too
    solver_->system.restore();
    if (solved && drift_ > 0.0) {  // fresh lists reach farther
      neighborhood.rebuild(store);
      return try_step(law, store, neighborhood, time_step, outcome);
    }
    return false;
  }
  drift_ += moved;
  outcome.max_speed = speed;
  outcome.max_force = solver_->system.largest_force();
  solver_->system.accept();
  return true;
}

void Implicit::make_solver(particles::Store& store, neighbor::Neighborhood& neighborhood) {
  solver_.reset();
  solver_ = std::make_unique<Solver>(*comm_, *scene_, store, neighborhood);
  rebuild_ = neighborhood.rebuilds();
  drift_ = 0.0;
}

}  // namespace packmpi::dynamics
