/// MPI and PETSc for the life of the process.
#pragma once
#include <string>

namespace packmpi::comm {

/// Starts MPI (and PETSc on MPI_COMM_WORLD) in its constructor if nobody did, and ends what it started.
/// Exactly one per process, made in main(). Collective over all ranks.
class Session {
 public:
  Session(int& argc, char**& argv);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

 private:
  bool owns_mpi_ = false;
};

/// Ends every rank at once with `code`, for the case where the ranks cannot agree any more.
[[noreturn]] void abort_all(int code, const std::string& words);

}  // namespace packmpi::comm
