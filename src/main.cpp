// packmpi: a scene in, a pack out. Everything is in run/.
#include <mpi.h>

#include "comm/session.hpp"
#include "run/program.hpp"

int main(int argc, char** argv) {
  const packmpi::comm::Session session(argc, argv);
  return packmpi::run::program(MPI_COMM_WORLD, argc, argv);
}
