/// MPI and PETSc for the life of the process.
#pragma once
#include <string>

namespace packmpi::comm {

/// Starts MPI (and PETSc on MPI_COMM_WORLD) in its constructor if nobody did, and ends what it started.
/// PETSc sees the environment's PETSC_OPTIONS but never the program's command line, and catches no signals.
/// Exactly one per process, made in main(). Collective over all ranks.
class Session {
 public:
  Session(int& argc, char**& argv);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  bool owns_mpi_ = false;
  bool owns_petsc_ = false;
};

/// Adds options in PETSc's own words, for example "-log_view :log.txt". Needs a Session. The same words on every rank.
/// Errors: Error(bad_input) when they do not start with '-', for -options_file, and with PETSc's reason. Local.
void petsc_options(const std::string& words);

/// Ends every rank at once with `code`, for the case where the ranks cannot agree any more.
[[noreturn]] void abort_all(int code, const std::string& words);

}  // namespace packmpi::comm
