/// The names of a run's outputs, and the right to write them.
#pragma once
#include <string>

#include "comm/comm.hpp"
#include "run/options.hpp"
#include "scene/scene.hpp"

namespace packmpi::run {

struct Files {
  std::string pack, summary, log, steps;
};

/// Collective. Makes sure the folder can be written, has room for the pack, and that nothing exists there already
/// (unless
/// --force); starts the log file. Throws on all ranks before anything is written: bad_input for existing files,
/// io_failure.
[[nodiscard]] Files claim_files(const comm::Comm& comm, const scene::Scene& scene, const Options& options);

/// Particles the scene will hold, roughly. Local.
[[nodiscard]] double expected_particles(const scene::Scene& scene);

}  // namespace packmpi::run
