#include "comm/session.hpp"

#include <mpi.h>
#include <petscsys.h>

#include <cstdio>
#include <cstdlib>

#include "base/error.hpp"

namespace packmpi::comm {
namespace {

/// PETSc's start and end have no caller who could do anything about a failure.
void require(PetscErrorCode failure, const char* what) {
  if (failure != 0) abort_all(static_cast<int>(ExitCode::numerical_failure), std::string("PETSc failed to ") + what);
}

std::string reason(PetscErrorCode failure) {
  const char* text = nullptr;
  PetscErrorMessage(failure, &text, nullptr);
  return text != nullptr ? text : "PETSc error " + std::to_string(failure);
}

/// PETSc passes over words that are not options; and a file of options is read by rank 0 alone, whose failure would
/// leave the others waiting, and is not kept with the run.
void refuse_misunderstandings(const std::string& words) {
  const auto first = words.find_first_not_of(' ');
  if (first != std::string::npos && words[first] != '-') {
    throw Error(ExitCode::bad_input, "PETSc options start with a '-', unlike \"" + words + "\"");
  }
  if (words.find("-options_file") != std::string::npos) {
    throw Error(ExitCode::bad_input, "PETSc options must be written out, without -options_file: \"" + words + "\"");
  }
}

}  // namespace

Session::Session(int& argc, char**& argv) {
  int running = 0;
  MPI_Initialized(&running);
  if (running == 0) {
    MPI_Init(&argc, &argv);
    owns_mpi_ = true;
  }
  PetscBool petsc_running = PETSC_FALSE;
  PetscInitialized(&petsc_running);
  if (petsc_running == PETSC_FALSE) {
    PETSC_COMM_WORLD = MPI_COMM_WORLD;
    require(PetscInitializeNoArguments(), "start");
    // PETSc's handler would turn our TERM and USR1, and every crash, into MPI_Abort without a stack.
    require(PetscPopSignalHandler(), "give the signals back");
    owns_petsc_ = true;
  }
}

Session::~Session() {
  if (owns_petsc_) PetscFinalize();
  if (owns_mpi_) MPI_Finalize();
}

void petsc_options(const std::string& words) {
  refuse_misunderstandings(words);
  PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);  // no traceback on stderr: the words below are for the user
  const PetscErrorCode failure = PetscOptionsInsertString(nullptr, words.c_str());
  PetscPopErrorHandler();
  if (failure != 0) throw Error(ExitCode::bad_input, "PETSc refuses the options \"" + words + "\": " + reason(failure));
  // PetscInitialize looks for -log_view once; asked for later, the log must be begun by hand.
  PetscBool wants_log = PETSC_FALSE;
  PetscOptionsHasName(nullptr, nullptr, "-log_view", &wants_log);
  if (wants_log == PETSC_TRUE) PetscLogDefaultBegin();
}

void abort_all(int code, const std::string& words) {
  std::fprintf(stderr, "packmpi: %s\n", words.c_str());
  std::fflush(stderr);
  int running = 0;
  MPI_Initialized(&running);
  if (running != 0) MPI_Abort(MPI_COMM_WORLD, code);
  std::_Exit(code);
}

}  // namespace packmpi::comm
