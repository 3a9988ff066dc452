/// PETSc's error codes as our errors.
#pragma once
#include <petscsys.h>

#include "comm/petsc.hpp"

namespace packmpi::dynamics {

/// Throws Error(numerical_failure) if PETSc failed.
inline void check_petsc(PetscErrorCode code) { comm::check_petsc(code, "solve an implicit step"); }

}  // namespace packmpi::dynamics
