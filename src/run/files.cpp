#include "run/files.hpp"

#include <fmt/core.h>

#include <filesystem>

#include "base/log.hpp"
#include "geometry/volume.hpp"
#include "output/pack.hpp"

namespace packmpi::run {
namespace {

constexpr double densest = 0.75;            // no random pile has more solid than this; 2D: 0.91
constexpr double bytes_a_particle = 112.0;  // of a pack file, VTK's index array included

}  // namespace

double expected_particles(const scene::Scene& scene) {
  const double height = scene.box.height() + scene.in.layers.thickness;
  const double solid = (scene.box.dimension == 3 ? densest : 0.91) * scene.box.floor_area() * height;
  return solid / geometry::volume(scene.box.dimension, scene.sizes.mean());
}

Files claim_files(const comm::Comm& comm, const scene::Scene& scene, const Options& options) {
  const std::string stem = (std::filesystem::path(options.folder) / scene.in.name).string();
  Files files{stem + ".hdf", stem + ".json", stem + ".log", stem + ".steps.csv"};
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0 || options.force) return;
    for (const std::string& path : {files.pack, files.summary, files.log, files.steps}) {
      std::error_code ignored;
      if (std::filesystem::exists(path, ignored)) {
        throw Error(ExitCode::bad_input, fmt::format("{} exists; use --force to replace it, or -o FOLDER", path));
      }
    }
  });
  output::check_writable(comm, options.folder, static_cast<std::int64_t>(bytes_a_particle * expected_particles(scene)));
  comm::agree_on(comm, [&] {
    if (comm.rank() == 0) {
      std::error_code ignored;
      std::filesystem::remove(files.log, ignored);  // --force: a new log, not a longer one
    }
    log::start(comm.rank(), files.log, options.verbosity);
  });
  return files;
}

}  // namespace packmpi::run
