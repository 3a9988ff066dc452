/// MPI and PETSc for the life of the process.
#pragma once
#include <mpi.h>

#include <cstdint>
#include <string>

namespace packmpi::comm {

/// Whom a PETSc that is started here belongs to: all ranks together, whose reports (-log_view) are one; or each rank
/// alone, which may start and end it without the others.
enum class PetscRanks { together, alone };

/// Starts MPI (and PETSc on MPI_COMM_WORLD) in its constructor if nobody did, and ends what it started.
/// A PETSc that is started here sees neither the command line, nor .petscrc of any folder, nor PETSC_OPTIONS and
/// PETSC_OPTIONS_YAML of the environment: what it is told is the scene's [petsc] options. It catches no signals and
/// prints no errors (comm/petsc.hpp). Where it starts MPI, glibc gives memory that is free back to the system, which
/// a library of PETSc forbids the whole process. One at a time. Collective over all ranks
/// where it starts MPI or a PETSc of them together.
class Session {
 public:
  Session(int& argc, char**& argv, PetscRanks petsc = PetscRanks::together);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  void start_petsc(PetscRanks ranks);
  bool owns_mpi_ = false;
  bool owns_petsc_ = false;
};

/// Did a launcher (mpirun, srun) start this process? By what Open MPI, PMIx and PMI tell their processes. Local; needs
/// no MPI.
[[nodiscard]] bool launched();

/// MPI_COMM_WORLD. Local.
[[nodiscard]] MPI_Comm world();
/// What MPI_Comm_c2f made a number of. Local.
[[nodiscard]] MPI_Comm from_number(std::int64_t number);
/// Of a communicator that is not ours. Local.
[[nodiscard]] int rank_in(MPI_Comm comm);
[[nodiscard]] int ranks_of(MPI_Comm comm);

/// Ends every rank at once with `code`, for the case where the ranks cannot agree any more.
[[noreturn]] void abort_all(int code, const std::string& words);

}  // namespace packmpi::comm
