/// MPI datatypes for libraries that want one (PetscSF); local.
#pragma once
#include <mpi.h>

namespace packmpi::comm {

/// A committed type of `count` contiguous doubles; end it with free_type().
[[nodiscard]] MPI_Datatype double_block(int count);
void free_type(MPI_Datatype& type) noexcept;

}  // namespace packmpi::comm
