/// Packs of small scenes, made on the first ranks of a test's own, stopped and gone on with.
#pragma once
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "base/error.hpp"
#include "pack/pack.hpp"
#include "run/make_pack.hpp"

namespace packmpi::test {

/// One folder of all ranks, which goes with the test. Scenes are named "shape.toml". Every function is collective.
class PacksOnRanks : public ::testing::Test {
 protected:
  void TearDown() override {
    world_.barrier();
    if (world_.rank() == 0) std::filesystem::remove_all(folder_);
    world_.barrier();
  }
  /// On the first `ranks` ranks; the gravest code of any.
  ExitCode run(const scene::Scene& scene, int ranks, std::int64_t steps, const char* restart) {
    run::Options options;
    options.folder = folder_;
    options.verbosity = log::Verbosity::quiet;
    options.max_steps = steps;
    options.restart = restart;
    options.force = options.restart.empty();
    MPI_Comm part = MPI_COMM_NULL;
    MPI_Comm_split(MPI_COMM_WORLD, world_.rank() < ranks ? 0 : 1, world_.rank(), &part);
    ExitCode code = ExitCode::done;
    if (world_.rank() < ranks) {
      const comm::Comm comm(part);
      try {
        record_ = run::make_pack(comm, scene, options);
      } catch (const Error& error) {
        code = error.code();
        words_ = error.what();
      }
    }
    MPI_Comm_free(&part);
    return static_cast<ExitCode>(world_.max(static_cast<std::int64_t>(code)));
  }
  [[nodiscard]] pack::PackRows rows() const {
    world_.barrier();
    return pack::read_pack(folder_ + "/shape.hdf");
  }

  comm::Comm world_{MPI_COMM_WORLD};
  std::string folder_ = world_.broadcast(
      0, (std::filesystem::temp_directory_path() / ("packmpi_shapes_" + std::to_string(::getpid()))).string());
  report::RunRecord record_;  ///< of the last pack
  std::string words_;         ///< of the last error
};

}  // namespace packmpi::test
