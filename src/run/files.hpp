/// The names of a run's outputs, and the right to write them.
#pragma once
#include <array>
#include <string>

#include "comm/comm.hpp"
#include "disk/lock.hpp"
#include "run/options.hpp"
#include "scene/scene.hpp"

namespace packmpi::run {

struct Files {
  std::string pack, summary, log, steps, analysis;
  std::array<std::string, 2> slots;  ///< checkpoints, written in turn
  std::string manifest;              ///< which of them is the newest; for people and scripts
  std::string stop;                  ///< STOP in the folder: if it appears, the run ends with a checkpoint
  std::string lock;                  ///< held while a run with these outputs is at work
};

/// Local. Also false where one may not look.
[[nodiscard]] bool is_there(const std::string& path);

/// The names of a scene's outputs. Local.
[[nodiscard]] Files files_of(const std::string& name, const Options& options);

/// Names, and the right to write them for as long as this lives.
struct Claim {
  Files files;
  disk::Lock lock;  ///< on rank 0
};

/// Collective. Makes sure the folder can be written, has room for the pack, that no other run has these outputs, and
/// that nothing exists there already (unless --force or --restart, which replace what an unfinished run left; --force
/// removes its checkpoints); starts the log file. Throws on all ranks before anything is written: bad_input for a run
/// at work and for existing files, io_failure.
[[nodiscard]] Claim claim_files(const comm::Comm& comm, const scene::Scene& scene, const Options& options);

/// Rank-local. Takes the lock; where the file system has none, a warning says that nothing keeps a second run out.
/// Throws as disk::Lock.
[[nodiscard]] disk::Lock take_lock(const std::string& path);

/// Collective. The first half of claim_files(), which refuses and writes nothing: before work that is done before the
/// files are claimed. Throws likewise.
void check_files(const comm::Comm& comm, const scene::Scene& scene, const Options& options);

/// The slots and the manifest, if they are there. Rank-local.
void remove_checkpoints(const Files& files);

/// Particles the scene will hold, roughly. Local.
[[nodiscard]] double expected_particles(const scene::Scene& scene);

}  // namespace packmpi::run
