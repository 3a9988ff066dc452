/// Making a pack from another program.
#pragma once
#include <mpi.h>

#include <cstdint>
#include <string>
#include <vector>

namespace packmpi {

/// What the command line's options are to the program.
struct PackOptions {
  std::string folder = ".";      ///< where NAME.hdf, NAME.json, NAME.log and NAME.steps.csv go; made if missing
  std::vector<std::string> set;  ///< changes of the scene, "key.path=value" (doc/input.md)
  bool force = false;            ///< existing outputs may be replaced
  bool quiet = true;             ///< only warnings and errors are printed
};

/// What came of it; the same on every rank.
struct PackResult {
  int code = 0;       ///< exit code of the program: 0 done, 3 a target was missed, others: no pack
  std::string error;  ///< one line: why there is no pack, or which targets it missed and what to change; else empty
  std::string file;   ///< path of the pack file (doc/file_format.md)
  std::int64_t particles = 0;
  double height = 0.0;           ///< [m]
  double phi = 0.0;              ///< solid fraction below the target height (CC16 eq. 22)
  double phi_bulk = 0.0;         ///< solid fraction of the bulk (doc/theory.md, "Solid fraction")
  double porosity_bulk = 1.0;    ///< 1 - phi_bulk
  double void_ratio_bulk = 0.0;  ///< (1 - phi_bulk) / phi_bulk
  double coordination = 0.0;     ///< mean touching particles
};

/// Makes the pack of a scene file on the ranks of `comm` and writes it. Collective over `comm`; throws nothing. A scene
/// with an [ensemble] of several packs is refused (code 2). Needs MPI to be initialised; starts PETSc on MPI_COMM_WORLD
/// for the time of the call if nobody has, so all ranks of MPI_COMM_WORLD must call it then (each with its own
/// communicator, if they like). An error that one of several ranks meets alone, as want of memory may be, cannot be
/// returned by all of them: that rank says it in one line on stderr and ends the job (MPI_Abort with the code).
/// Signals are the caller's; a SIGXFSZ that is not ignored ends the process at a file limit. Cost: the whole run.
[[nodiscard]] PackResult make_pack(MPI_Comm comm, const std::string& scene_file, const PackOptions& options = {});

}  // namespace packmpi
