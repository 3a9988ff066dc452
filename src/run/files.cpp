#include "run/files.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>

#include "base/log.hpp"
#include "disk/text_file.hpp"
#include "geometry/volume.hpp"
#include "pack/pack.hpp"

namespace packmpi::run {
namespace {

constexpr double densest = 0.75;                         // no random bed has more solid than this; 2D: 0.91
constexpr double bytes_a_particle = 112.0 + 2.0 * 88.0;  // of a pack file and two checkpoints

void remove_if_there(const std::string& path) {
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

void check_free(const Files& files, const Options& options) {
  const auto refuse = [](const std::string& words) { throw Error(ExitCode::bad_input, words); };
  if (is_there(files.stop) && !options.member) refuse(files.stop + " exists and would end the run at once; remove it");
  if (options.force) return;
  const bool unfinished = is_there(files.slots[0]) || is_there(files.slots[1]);
  if (!options.restart.empty()) {
    if (!unfinished && is_there(files.pack) && is_there(files.summary)) {
      refuse(files.pack + " exists and there is no checkpoint: the run is finished; use --force to make it anew");
    }
    return;
  }
  if (unfinished) {
    refuse(
        fmt::format("there are checkpoints of an unfinished run ({}); --restart auto goes on from them, --force "
                    "begins anew",
                    is_there(files.slots[0]) ? files.slots[0] : files.slots[1]));
  }
  for (const std::string& path : {files.pack, files.summary, files.log, files.steps}) {
    if (is_there(path)) refuse(fmt::format("{} exists; use --force to replace it, or -o FOLDER", path));
  }
}

}  // namespace

void remove_checkpoints(const Files& files) {
  remove_if_there(files.manifest);
  for (const std::string& slot : files.slots) {
    remove_if_there(slot);
    remove_if_there(slot + ".tmp");
  }
}

double expected_particles(const scene::Scene& scene) {
  const double height = scene.container.height() + scene.in.layers.thickness;
  const double solid = (scene.container.dimension == 3 ? densest : 0.91) * scene.container.mean_area() * height;
  const double mean =
      geometry::volume(scene.container.dimension, 1.0) * scene.sizes.curve().moment(scene.container.dimension);
  const input::Layers& layers = scene.in.layers;
  const double a_layer = layers.fraction * scene.container.mean_area() * layers.thickness / mean + 1.0;
  const double full = solid / mean;
  if (scene.in.particles.count > 0) return static_cast<double>(scene.in.particles.count);
  return layers.maximum > 0 ? std::min(full, static_cast<double>(layers.maximum) * a_layer) : full;
}

bool is_there(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

Files files_of(const std::string& name, const Options& options) {
  const std::string stem = (std::filesystem::path(options.folder) / name).string();
  return {.pack = stem + ".hdf",
          .summary = stem + ".json",
          .log = stem + ".log",
          .steps = stem + ".steps.csv",
          .analysis = stem + ".analysis.json",
          .slots = {stem + ".ckpt.A.hdf", stem + ".ckpt.B.hdf"},
          .manifest = stem + ".ckpt.json",
          .stop = (std::filesystem::path(options.folder) / "STOP").string(),
          .lock = stem + ".lock"};
}

disk::Lock take_lock(const std::string& path) {
  disk::Lock lock(path);
  if (!lock.held()) log::warn(path + ": this file system has no locks; see to it that no second run writes here");
  return lock;
}

void check_files(const comm::Comm& comm, const scene::Scene& scene, const Options& options) {
  const Files files = files_of(scene.in.name, options);
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0) return;
    disk::refuse_if_locked(files.lock);  // before words about files that a run at work has there
    check_free(files, options);
  });
  disk::check_writable(comm, options.folder, static_cast<std::int64_t>(bytes_a_particle * expected_particles(scene)));
}

Claim claim_files(const comm::Comm& comm, const scene::Scene& scene, const Options& options) {
  Claim claim{.files = files_of(scene.in.name, options), .lock = {}};
  const Files& files = claim.files;
  check_files(comm, scene, options);
  comm::agree_on(comm, [&] {
    if (comm.rank() == 0) {
      claim.lock = take_lock(files.lock);
      check_free(files, options);                               // another run may have come and gone since
      if (options.restart.empty()) remove_if_there(files.log);  // --force: a new log, not a longer one
      if (options.restart.empty()) remove_checkpoints(files);
    }
    log::start(comm.rank(), files.log, options.verbosity, options.log_format);
  });
  return claim;
}

}  // namespace packmpi::run
