// The library's own face: what make_pack() gives back, with a pack and without.
#include "packmpi/make_pack.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "comm/comm.hpp"

namespace packmpi {
namespace {

constexpr const char* scene = R"([container]
size = [0.2, 0.2, 0.05]
[particles]
density = 1000.0
youngs_modulus = 1.0e7
poisson_ratio = 0.25
radius = { distribution = "equal", value = 0.02 }
[layers]
thickness = 0.06
fraction = 0.15
duration = 0.02
[jamming]
gravity = 5.0
[dynamics]
time_step = 1.0e-4
)";

class MakePack : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto mine = std::filesystem::temp_directory_path() / ("packmpi-library-" + std::to_string(getpid()));
    folder_ = comm_.broadcast(0, mine.string());
    if (comm_.rank() == 0) {
      std::filesystem::create_directories(folder_);
      std::ofstream(folder_ + "/a.toml") << scene;
    }
    comm_.barrier();
  }
  void TearDown() override {
    comm_.barrier();
    if (comm_.rank() == 0) std::filesystem::remove_all(folder_);
  }
  [[nodiscard]] PackResult make(const std::vector<std::string>& set) const {
    PackOptions options;
    options.folder = folder_;
    options.set = set;
    return make_pack(MPI_COMM_WORLD, folder_ + "/a.toml", options);
  }
  comm::Comm comm_{MPI_COMM_WORLD};
  std::string folder_;
};

TEST_F(MakePack, GivesErrorsBackOnAllRanks) {
  const PackResult missing = make_pack(MPI_COMM_WORLD, folder_ + "/none.toml");
  EXPECT_EQ(missing.code, 2);
  EXPECT_EQ(missing.error, folder_ + "/none.toml: cannot be opened (No such file or directory); check the path");
  const PackResult wrong = make({"petsc.options=-info :x"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_NE(wrong.error.find("petsc.options: -info is not taken from a scene"), std::string::npos) << wrong.error;
}

TEST_F(MakePack, RefusesAnEnsemble) {
  const PackResult several = make({"ensemble.sets=2", "ensemble.packs=3"});
  EXPECT_EQ(several.code, 2);
  EXPECT_NE(several.error.find("ensemble: 6 packs, and make_pack makes one"), std::string::npos) << several.error;
  EXPECT_FALSE(std::filesystem::exists(folder_ + "/a.hdf"));
  EXPECT_TRUE(several.file.empty());
}

TEST_F(MakePack, MakesOne) {
  const PackResult one = make({});
  EXPECT_TRUE(one.code == 0 || one.code == 3) << one.error;
  EXPECT_EQ(one.file, folder_ + "/a.hdf");
  EXPECT_GT(one.particles, 0);
  EXPECT_TRUE(std::filesystem::exists(one.file));
}

}  // namespace
}  // namespace packmpi
