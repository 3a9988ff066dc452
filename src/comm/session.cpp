#include "comm/session.hpp"

#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <mpi.h>
#include <petscsys.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"

namespace packmpi::comm {
namespace {

/// A variable of the environment that is not there while this lives. PETSc ends in an error of many lines where it
/// names a file that is missing, and runs what is in it where it is not.
class WithoutVariable {
 public:
  explicit WithoutVariable(const char* name) : name_(name) {
    if (const char* value = std::getenv(name); value != nullptr) value_ = value;
    unsetenv(name);
  }
  ~WithoutVariable() {
    if (value_) setenv(name_, value_->c_str(), 1);
  }
  WithoutVariable(const WithoutVariable&) = delete;
  WithoutVariable& operator=(const WithoutVariable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> value_;
};

/// For Open MPI, in a program that no launcher started.
void prepare_single_process() {
  // No daemon beside it, unless it spawns others: a tenth of a second less.
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  // No folder of the session: all such programs of a user share one, and one that starts while another ends, and takes
  // the folder away, does not start (one of a hundred, six side by side).
  setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
}

/// Gives memory that is free back to the system. SuperLU_DIST, which comes with PETSc, forbids it as it is loaded, for
/// the whole program: what a large array has had is then the program's until it ends.
void give_memory_back() {
#ifdef __GLIBC__
  constexpr int large = 4 << 20;  // [bytes] what is smaller comes and goes too often to be asked for each time
  mallopt(M_MMAP_MAX, 65536);     // glibc's own number
  mallopt(M_MMAP_THRESHOLD, large);
  mallopt(M_TRIM_THRESHOLD, 2 * large);
#endif
}

}  // namespace

bool launched() {
  constexpr std::array names{"OMPI_COMM_WORLD_SIZE", "PMIX_NAMESPACE", "PMIX_RANK", "PMI_RANK", "PMI_SIZE"};
  return std::ranges::any_of(names, [](const char* name) { return std::getenv(name) != nullptr; });
}

void Session::start_petsc(PetscRanks ranks) {
  // PETSc keeps these. Its handler would turn our TERM and USR1, and every crash, into MPI_Abort without a stack.
  static std::array<char, 8> program{"packmpi"};
  static std::array<char, 14> no_files{"-skip_petscrc"};
  static std::array<char, 19> no_signals{"-no_signal_handler"};
  static std::array<char*, 4> words{program.data(), no_files.data(), no_signals.data(), nullptr};
  static int count = 3;
  static char** list = words.data();
  const WithoutVariable options("PETSC_OPTIONS");
  const WithoutVariable yaml("PETSC_OPTIONS_YAML");
  PETSC_COMM_WORLD = ranks == PetscRanks::together ? MPI_COMM_WORLD : MPI_COMM_SELF;
  const PetscErrorCode failure = PetscInitialize(&count, &list, nullptr, nullptr);
  // There is no caller who could do anything about it.
  if (failure != 0) abort_all(static_cast<int>(ExitCode::numerical_failure), "PETSc failed to start");
}

Session::Session(int& argc, char**& argv, PetscRanks petsc) {
  int running = 0;
  MPI_Initialized(&running);
  if (running == 0) {
    if (!launched()) prepare_single_process();
    give_memory_back();
    MPI_Init(&argc, &argv);
    owns_mpi_ = true;
  }
  PetscBool petsc_running = PETSC_FALSE;
  PetscInitialized(&petsc_running);
  if (petsc_running == PETSC_FALSE) {
    start_petsc(petsc);
    owns_petsc_ = true;
  }
  PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);  // our errors have its words (comm/petsc.hpp)
}

Session::~Session() {
  if (!owns_petsc_) PetscPopErrorHandler();
  if (owns_petsc_) PetscFinalize();
  if (owns_mpi_) MPI_Finalize();
}

MPI_Comm world() { return MPI_COMM_WORLD; }

MPI_Comm from_number(std::int64_t number) { return MPI_Comm_f2c(static_cast<MPI_Fint>(number)); }

int rank_in(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

int ranks_of(MPI_Comm comm) {
  int ranks = 1;
  MPI_Comm_size(comm, &ranks);
  return ranks;
}

void abort_all(int code, const std::string& words) {
  (void)std::signal(SIGTERM, SIG_DFL);  // another rank may be quicker: then this one is to end without a word
  std::fprintf(stderr, "packmpi: %s\n", text::printable(words).c_str());
  std::fflush(stderr);
  int running = 0;
  MPI_Initialized(&running);
  if (running != 0) MPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);
}

}  // namespace packmpi::comm
