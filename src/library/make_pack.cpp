// The whole program as one call: include/packmpi/make_pack.hpp.
#include "packmpi/make_pack.hpp"

#include <fmt/core.h>

#include <filesystem>

#include "base/voids.hpp"
#include "comm/petsc.hpp"
#include "comm/session.hpp"
#include "run/make_pack.hpp"
#include "start/fit.hpp"

namespace packmpi {
namespace {

run::Options options_of(const std::string& scene_file, const PackOptions& options) {
  run::Options out;
  out.scene = scene_file;
  out.folder = options.folder;
  out.overrides.set = options.set;
  out.force = options.force;
  out.verbosity = options.quiet ? log::Verbosity::quiet : log::Verbosity::normal;
  return out;
}

void refuse_ensemble(const input::Input& in) {
  const int packs = in.ensemble.sets * in.ensemble.packs;
  if (packs == 1) return;
  throw Error(ExitCode::bad_input,
              fmt::format("{}: ensemble: {} packs, and make_pack makes one; call it for each seed with set = "
                          "{{\"ensemble.sets=1\", \"ensemble.packs=1\", \"seed=...\"}}, or use the program",
                          in.file, packs));
}

PackResult make(const comm::Comm& comm, const run::Options& options) {
  const input::Input in = start::with_start(comm, input::read(comm, options.scene, options.overrides));
  refuse_ensemble(in);
  comm::petsc_options(in.petsc.options);
  const report::RunRecord record = run::make_pack(comm, scene::build(in), options);
  PackResult result;
  result.code = static_cast<int>(record.targets_met ? ExitCode::done : ExitCode::target_missed);
  result.file = (std::filesystem::path(options.folder) / (in.name + ".hdf")).string();
  result.particles = record.particles;
  result.height = record.height;
  result.phi = record.phi;
  result.phi_bulk = record.phi_bulk;
  result.porosity_bulk = porosity(record.phi_bulk);
  result.void_ratio_bulk = void_ratio(record.phi_bulk);
  result.coordination = record.rest.network.coordination;
  result.error = report::missed_words(record, "; ");
  return result;
}

}  // namespace

PackResult make_pack(MPI_Comm world, const std::string& scene_file, const PackOptions& options) {
  int no_arguments = 0;
  char** none = nullptr;
  const comm::Session session(no_arguments, none);
  const comm::Comm comm(world);
  PackResult result;
  const comm::Failure failure = comm::end_together(comm, [&] { result = make(comm, options_of(scene_file, options)); });
  if (failure.code != ExitCode::done) {
    result = {};
    result.code = static_cast<int>(failure.code);
    result.error = failure.words;
  }
  log::finish();
  return result;
}

}  // namespace packmpi
