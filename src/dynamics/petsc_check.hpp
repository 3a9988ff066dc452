/// PETSc's error codes as our errors.
#pragma once
#include <petscsys.h>

#include <string>

#include "base/error.hpp"

namespace packmpi::dynamics {

/// Throws Error(numerical_failure) if PETSc failed. Its own words are on stderr then.
inline void check_petsc(PetscErrorCode code) {
  if (code != 0) {
    throw Error(ExitCode::numerical_failure,
                "PETSc failed in the implicit scheme (error " + std::to_string(code) + ")");
  }
}

}  // namespace packmpi::dynamics
