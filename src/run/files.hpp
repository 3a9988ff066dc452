/// The names of a run's outputs, and the right to write them.
#pragma once
#include <array>
#include <string>

#include "comm/comm.hpp"
#include "run/options.hpp"
#include "scene/scene.hpp"

namespace packmpi::run {

struct Files {
  std::string pack, summary, log, steps;
  std::array<std::string, 2> slots;  ///< checkpoints, written in turn
  std::string manifest;              ///< which of them is the newest; for people and scripts
  std::string stop;                  ///< STOP in the folder: if it appears, the run ends with a checkpoint
};

/// Collective. Makes sure the folder can be written, has room for the pack, and that nothing exists there already
/// (unless --force or --restart, which replace what an unfinished run left; --force removes its checkpoints); starts
/// the log file. Throws on all ranks before anything is written: bad_input for existing files, io_failure.
[[nodiscard]] Files claim_files(const comm::Comm& comm, const scene::Scene& scene, const Options& options);

/// The slots and the manifest, if they are there. Rank-local.
void remove_checkpoints(const Files& files);

/// Particles the scene will hold, roughly. Local.
[[nodiscard]] double expected_particles(const scene::Scene& scene);

}  // namespace packmpi::run
