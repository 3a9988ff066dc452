/// A whole run of a scene in a folder of its own, which is gone afterwards.
#pragma once
#include <unistd.h>

#include <filesystem>
#include <string>

#include "run/make_pack.hpp"

namespace packmpi::test {

/// Collective over MPI_COMM_WORLD. `name` tells tests that run at the same time apart.
inline report::RunRecord packed(const input::Input& in, const std::string& name) {
  const comm::Comm comm(MPI_COMM_WORLD);
  run::Options options;
  options.folder = std::filesystem::temp_directory_path() / ("packmpi_" + name + "_" + std::to_string(::getppid()));
  options.force = true;
  options.verbosity = log::Verbosity::quiet;
  report::RunRecord record = run::make_pack(comm, scene::build(in), options);
  comm.barrier();
  if (comm.rank() == 0) std::filesystem::remove_all(options.folder);
  comm.barrier();
  return record;
}

}  // namespace packmpi::test
