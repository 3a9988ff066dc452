/// MPI and PETSc for the life of the process.
#pragma once
#include <string>

namespace packmpi::comm {

/// Starts MPI (and PETSc on MPI_COMM_WORLD) in its constructor if nobody did, and ends what it started.
/// A PETSc that is started here sees neither the command line, nor .petscrc of any folder, nor PETSC_OPTIONS and
/// PETSC_OPTIONS_YAML of the environment: what it is told is the scene's [petsc] options. It catches no signals and
/// prints no errors (comm/petsc.hpp). One at a time. Collective over all ranks.
class Session {
 public:
  Session(int& argc, char**& argv);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  void start_petsc();
  bool owns_mpi_ = false;
  bool owns_petsc_ = false;
};

/// Ends every rank at once with `code`, for the case where the ranks cannot agree any more.
[[noreturn]] void abort_all(int code, const std::string& words);

}  // namespace packmpi::comm
