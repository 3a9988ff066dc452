// packmpi: a scene in, a pack out. Start reading in run/make_pack.cpp.
#include <mpi.h>

#include <cstdlib>
#include <new>

#include "base/error.hpp"
#include "base/memory.hpp"
#include "cli/process.hpp"
#include "cli/program.hpp"
#include "cli/tools.hpp"
#include "comm/comm.hpp"
#include "comm/session.hpp"

// As the standard ones but for the words: std::bad_alloc does not tell how much was wanted.
void* operator new(std::size_t bytes) {
  if (void* place = std::malloc(bytes)) return place;
  throw packmpi::OutOfMemory(bytes);
}
void operator delete(void* place) noexcept { std::free(place); }
void operator delete(void* place, std::size_t /*bytes*/) noexcept { std::free(place); }

int main(int argc, char** argv) {
  if (packmpi::cli::wants_tool(argc, argv)) return packmpi::cli::start_tool(argc, argv);
  if (!packmpi::cli::prepare_process()) return static_cast<int>(packmpi::ExitCode::io_failure);
  try {
    const packmpi::comm::Session session(argc, argv);
    return packmpi::cli::program(MPI_COMM_WORLD, argc, argv);
  } catch (...) {  // before or after what program() catches itself
    const packmpi::comm::Failure failure = packmpi::comm::caught(packmpi::ExitCode::numerical_failure);
    packmpi::comm::abort_all(static_cast<int>(failure.code), failure.words);
  }
}
