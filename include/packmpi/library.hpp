/// MPI and PETSc for programs that do not start them themselves.
#pragma once
#include <mpi.h>

#include <cstdint>
#include <memory>

namespace packmpi {

/// Starts MPI, and PETSc on each rank for itself, unless they are running; ends what it started. One at a time, for as
/// long as the process needs packmpi: MPI can be started once only. Collective over all ranks where it starts MPI, else
/// local: PETSc keeps no rank waiting, so that a part of the ranks may use packmpi alone.
class Library {
 public:
  Library();
  ~Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

 private:
  struct Running;
  std::unique_ptr<Running> running_;
};

/// All ranks of the job. Local; MPI must be running.
[[nodiscard]] MPI_Comm all_ranks();

/// A communicator that another language hands over as MPI_Comm_c2f gives it (mpi4py: comm.py2f()). Local.
[[nodiscard]] MPI_Comm communicator_of(std::int64_t handle);

/// Local.
[[nodiscard]] int rank_in(MPI_Comm comm);
[[nodiscard]] int ranks_of(MPI_Comm comm);

}  // namespace packmpi
