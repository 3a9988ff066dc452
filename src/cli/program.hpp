/// The program behind main(): command line to exit code.
#pragma once
#include <mpi.h>

namespace packmpi::cli {

/// Collective over `world`. Reads the command line, does what it says, returns the exit code, the same on every rank.
/// An error is one line on stderr: of rank 0, or, where one rank alone met it, of that rank, which then ends the job
/// (comm::end_together). MPI and PETSc must be running (comm::Session).
[[nodiscard]] int program(MPI_Comm world, int argc, const char* const* argv);

}  // namespace packmpi::cli
