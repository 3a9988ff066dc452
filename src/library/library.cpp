// MPI and PETSc for those who have not started them: include/packmpi/library.hpp.
#include "packmpi/library.hpp"

#include "comm/comm.hpp"
#include "comm/session.hpp"

namespace packmpi {

struct Library::Running {
  int no_arguments = 0;
  char** none = nullptr;
  comm::Session session{no_arguments, none, comm::PetscRanks::alone};
};

Library::Library() : running_(std::make_unique<Running>()) {}
Library::~Library() = default;

MPI_Comm all_ranks() { return comm::world(); }

MPI_Comm communicator_of(std::int64_t handle) { return comm::from_number(handle); }

int rank_in(MPI_Comm comm) { return comm::rank_in(comm); }

int ranks_of(MPI_Comm comm) { return comm::ranks_of(comm); }

}  // namespace packmpi
