// For a whole program: LD_PRELOAD=libpackmpi_mpi_faults.so makes one MPI call of one rank throw, as if an error had
// been met there alone, while the other ranks wait in that call. The program itself knows nothing of it.
//   MPI_FAULTS_RANK    on which rank of Open MPI's
//   MPI_FAULTS_CALL    which call throws, from 1 on; 0: none does
//   MPI_FAULTS_KIND    "error": Error(io_failure); "memory": std::bad_alloc; "other": std::runtime_error
//   MPI_FAULTS_REPORT  file that gets the number of calls at MPI_Finalize
#include <dlfcn.h>
#include <mpi.h>

#include <cstdio>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <string_view>

#include "base/error.hpp"

namespace {

long calls = 0;

bool is_mine() {
  const char* rank = std::getenv("MPI_FAULTS_RANK");
  const char* mine = std::getenv("OMPI_COMM_WORLD_RANK");
  return rank != nullptr && mine != nullptr && std::string_view(rank) == mine;
}

bool in_packmpi(const void* caller) {
  Dl_info object{};
  return dladdr(caller, &object) != 0 && std::string_view(object.dli_fname).find("packmpi") != std::string_view::npos;
}

void count(const void* caller) {
  static const bool here = is_mine();
  static const char* const wanted = std::getenv("MPI_FAULTS_CALL");
  static const char* const kind = std::getenv("MPI_FAULTS_KIND");
  if (!here || wanted == nullptr || kind == nullptr || !in_packmpi(caller) || ++calls != std::atol(wanted)) return;
  if (std::string_view(kind) == "memory") throw std::bad_alloc();
  if (std::string_view(kind) == "other") throw std::runtime_error("a fault for the test");
  throw packmpi::Error(packmpi::ExitCode::io_failure, "a fault for the test");
}

}  // namespace

extern "C" {

int MPI_Allreduce(const void* send, void* receive, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  count(__builtin_return_address(0));
  return PMPI_Allreduce(send, receive, n, type, op, comm);
}

int MPI_Bcast(void* data, int n, MPI_Datatype type, int root, MPI_Comm comm) {
  count(__builtin_return_address(0));
  return PMPI_Bcast(data, n, type, root, comm);
}

int MPI_Exscan(const void* send, void* receive, int n, MPI_Datatype type, MPI_Op op, MPI_Comm comm) {
  count(__builtin_return_address(0));
  return PMPI_Exscan(send, receive, n, type, op, comm);
}

int MPI_Issend(const void* data, int n, MPI_Datatype type, int to, int tag, MPI_Comm comm, MPI_Request* request) {
  count(__builtin_return_address(0));
  return PMPI_Issend(data, n, type, to, tag, comm, request);
}

int MPI_Finalize() {
  const char* report = std::getenv("MPI_FAULTS_REPORT");
  FILE* file = report != nullptr && is_mine() ? std::fopen(report, "w") : nullptr;
  if (file != nullptr) {
    (void)std::fprintf(file, "%ld\n", calls);
    (void)std::fclose(file);
  }
  return PMPI_Finalize();
}
}
