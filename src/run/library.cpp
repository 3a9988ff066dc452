// The public face of the program: include/packmpi/make_pack.hpp.
#include <filesystem>

#include "comm/session.hpp"
#include "packmpi/make_pack.hpp"
#include "run/make_pack.hpp"

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

PackResult make(const comm::Comm& comm, const run::Options& options) {
  const input::Input in = input::read(comm, options.scene, options.overrides);
  comm::petsc_options(in.petsc.options);
  const report::RunRecord record = run::make_pack(comm, scene::build(in), options);
  PackResult result;
  result.code = static_cast<int>(run::targets_met(record) ? ExitCode::done : ExitCode::target_missed);
  result.file = (std::filesystem::path(options.folder) / (in.name + ".hdf")).string();
  result.particles = record.particles;
  result.height = record.height;
  result.phi = record.phi;
  result.phi_bulk = record.phi_bulk;
  result.coordination = record.coordination;
  return result;
}

}  // namespace

PackResult make_pack(MPI_Comm world, const std::string& scene_file, const PackOptions& options) {
  int no_arguments = 0;
  char** none = nullptr;
  const comm::Session session(no_arguments, none);
  const comm::Comm comm(world);
  PackResult result;
  try {
    result = make(comm, options_of(scene_file, options));
  } catch (const Error& error) {  // thrown on every rank alike
    result.code = static_cast<int>(error.code());
    result.error = error.what();
  }
  log::finish();
  return result;
}

}  // namespace packmpi
