/// From a scene to packs, and what there is to be known before.
#pragma once
#include <mpi.h>

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "packmpi/packing.hpp"
#include "packmpi/scene.hpp"

namespace packmpi {

/// Where a run is.
struct Progress {
  const char* stage = "";      ///< "inserting", "settling" (a layer) or "relaxing" (the final stage)
  std::int64_t layer = 0;      ///< from 1
  double share = 0.0;          ///< of the stage that is done, 0 .. 1
  std::int64_t particles = 0;  ///< inserted so far, on all ranks
  double height = 0.0;         ///< [m] of the bed, after the last layer that has settled
};

/// What a run is asked beside its scene.
struct RunOptions {
  /// Where NAME.hdf and the other outputs go (doc/file_format.md); made if missing. "": nothing is written.
  std::string folder{};
  bool force = false;      ///< existing outputs may be replaced
  std::string restart{};   ///< with a folder: "auto", a checkpoint file, or "": from the beginning
  double max_hours = 0.0;  ///< [h] with a folder: then a checkpoint and Failure (75); 0: no limit
  /// Called on each rank that gives one, with the same numbers, every output.log_every steps and at the ends of layers.
  /// What it throws ends the run on all ranks: it comes out of make_packing() there, and a Failure (75) on the others.
  std::function<void(const Progress&)> progress{};
};

/// Makes the pack of a scene on the ranks of `comm`, which may be a part of all. Collective over `comm`; MPI and PETSc
/// must be running (Library). Same bits on any number of ranks, and as the program's. A pack that missed a target is
/// returned: Packing::missed(). Throws Failure on all ranks of `comm`: 2 (also for a scene with an [ensemble]), 4, 5,
/// 6,
/// 75. What one rank alone meets, as want of memory may be, ends the job with one line. Cost: the whole run.
[[nodiscard]] Packing make_packing(const Scene& scene, MPI_Comm comm, const RunOptions& options = {});

/// All packs of a scene with an [ensemble], into options.folder ("" is the working folder), and their tables
/// (doc/ensembles.md). Collective. Returns the worst exit code of its packs; throws Failure, as make_packing().
/// `progress` is not called.
[[nodiscard]] int make_ensemble(const Scene& scene, MPI_Comm comm, const RunOptions& options = {});

/// What follows from a scene, as JSON: "particles" (about), "time_step", "time_step_limit" [s], "most_ranks",
/// "mean_overlap" [radii, at rest], "restitution", "remarks" and "warnings" (lists of sentences). Collective. Throws
/// Failure (2).
[[nodiscard]] std::string check(const Scene& scene, MPI_Comm comm);

/// What estimate() is asked; as it is: what the scene comes to.
struct EstimateOptions {
  std::int64_t particles = 0;  ///< so many; the height is found, or with a height the floor; 0: as the scene has it
  double height = 0.0;         ///< [m] H_d; 0: as the scene has it
  std::vector<std::optional<double>> floor{};  ///< [m] its sides, none: open; empty: as the scene has it
  int ranks = 0;                               ///< 0: those of comm
  bool probe = true;                           ///< this machine is tried for a second or two
};

/// What a scene will take, as JSON, that of `packmpi estimate --json` (doc/estimate.md). Collective. Throws Failure
/// (2).
[[nodiscard]] std::string estimate(const Scene& scene, MPI_Comm comm, const EstimateOptions& options = {});

/// Analyses a pack file and writes NAME.analysis.json beside it (doc/analyze.md). Collective. Returns the table for
/// people. Throws Failure (5).
std::string analyze(MPI_Comm comm, const std::string& pack);

/// What of a pack is written, and where.
struct ConvertOptions {
  std::string file{};        ///< "": beside the pack, with the format's ending
  std::string trim{"none"};  ///< "drop" or "cut": what is higher than H_d is left out
  std::string cut{};         ///< a specimen inside, "cylinder:diameter=0.15,height=0.3" (doc/vessels.md); "": all
  std::array<int, 2> copies{1, 1};  ///< side by side along x and y, periodic axes only
  bool force = false;               ///< files that exist may be replaced
};

/// What was written.
struct Converted {
  std::vector<std::string> files;
  std::int64_t particles = 0;
  double volume = 0.0;        ///< [m3] of the particles as spheres
  std::string cut{};          ///< what was cut out, in words; "": nothing
  double cut_fraction = 0.0;  ///< its solid fraction, spheres cut by its sides
  std::string springs{};      ///< what became of the springs of friction, in words; "": nothing to tell
};

/// Writes a pack file in the format of another code (doc/convert.md). Collective. Throws Failure (2, 5).
Converted convert(MPI_Comm comm, const std::string& pack, const std::string& format,
                  const ConvertOptions& options = {});

}  // namespace packmpi
