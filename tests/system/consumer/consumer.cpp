// A program of somebody else's that uses the installed library.
#include <mpi.h>

#include <iostream>
#include <packmpi/packmpi.hpp>

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  if (rank == 0) {
    std::cout << "packmpi " << packmpi::version() << " (" << packmpi::git_id() << ", " << packmpi::compiler() << ")\n";
  }
  MPI_Finalize();
  return 0;
}
