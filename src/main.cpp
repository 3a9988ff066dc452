// packmpi: a scene in, a pack out. Start reading in run/make_pack.cpp.
#include <mpi.h>

#include "cli/program.hpp"
#include "cli/tools.hpp"
#include "comm/session.hpp"

int main(int argc, char** argv) {
  if (packmpi::cli::wants_tool(argc, argv)) return packmpi::cli::start_tool(argc, argv);
  const packmpi::comm::Session session(argc, argv);
  return packmpi::cli::program(MPI_COMM_WORLD, argc, argv);
}
