// Ensembles: each pack as when run alone, tables, stopping and going on, a pack that fails.
#include "run/ensemble.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "input/read.hpp"
#include "pack/pack.hpp"
#include "report/ensemble.hpp"
#include "run/make_pack.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;

const std::string scene_text =
    "[container]\nsize = [0.3, 0.3, 0.1]\n"
    "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e8\npoisson_ratio = 0.25\n"
    "radius = { distribution = \"equal\", value = 0.02 }\n"
    "[layers]\nthickness = 0.1\nfraction = 0.25\nduration = 0.02\nmaximum = 2\n[jamming]\ngravity = 2.0\n"
    "[dynamics]\ntime_step = 1.0e-4\n[ensemble]\nsets = 2\npacks = 2\n";

class Ensembles : public ::testing::Test {
 protected:
  const comm::Comm comm_{MPI_COMM_WORLD};
  const fs::path folder_ = fs::path(testing::TempDir()) / ("packmpi_ensemble_" + std::to_string(comm_.size()));

  void SetUp() override {
    if (comm_.rank() == 0) fs::remove_all(folder_);
    comm_.barrier();
  }
  [[nodiscard]] input::Input scene() const { return input::parse(scene_text, "box.toml", {}); }
  [[nodiscard]] Options options() const {
    Options o;
    o.folder = folder_.string();
    o.verbosity = log::Verbosity::quiet;
    return o;
  }
  [[nodiscard]] int make(const Options& o) const {
    testing::internal::CaptureStdout();
    int code = -1;
    try {
      code = make_ensemble(comm_, scene(), o);
    } catch (const Error& error) {
      code = static_cast<int>(error.code());
    }
    testing::internal::GetCapturedStdout();
    return code;
  }
  [[nodiscard]] pack::PackRows pack(const std::string& name) const {
    return pack::read_pack((folder_ / (name + ".hdf")).string());
  }
  [[nodiscard]] nlohmann::json table() const {
    std::ifstream file(folder_ / "box.ensemble.json");
    return nlohmann::json::parse(file);
  }
  void expect_as_when_run_alone() const {
    for (const Member& member : members(scene())) {
      input::Input alone = input::parse(
          scene_text, "box.toml", {{"seed=" + std::to_string(member.seed), "ensemble.sets=1", "ensemble.packs=1"}});
      alone.name = "alone";
      Options o = options();
      o.force = true;
      static_cast<void>(make_pack(comm_, scene::build(alone), o));
      const pack::PackRows a = pack(member.name), b = pack("alone");
      EXPECT_EQ(a.position, b.position) << member.name;
      EXPECT_EQ(a.velocity, b.velocity) << member.name;
      EXPECT_EQ(a.spin, b.spin) << member.name;
    }
  }
};

TEST_F(Ensembles, MembersHaveSeedsAndNamesOfTheirOwn) {
  const std::vector<Member> all = members(scene());
  ASSERT_EQ(all.size(), 4U);
  EXPECT_EQ(all[0].name, "box_1_1");
  EXPECT_EQ(all[3].name, "box_2_2");
  EXPECT_EQ(all[3].seed, all[0].seed + 3);
  input::Input last = scene();
  last.seed = 9223372036854775806ULL;
  EXPECT_THROW(static_cast<void>(members(last)), Error);
}

TEST_F(Ensembles, EachPackIsAsWhenRunAloneAndTheTableIsRight) {
  EXPECT_EQ(make(options()), 0);
  const nlohmann::json json = table();
  ASSERT_EQ(json["packs"].size(), 4U);
  double sum = 0.0, squares = 0.0;
  for (const auto& row : json["packs"]) sum += row["phi_bulk"].get<double>();
  for (const auto& row : json["packs"]) squares += std::pow(row["phi_bulk"].get<double>() - sum / 4.0, 2);
  const auto& all = json["statistics"]["all"]["phi_bulk"];
  EXPECT_EQ(all["count"], 4);
  EXPECT_NEAR(all["mean"].get<double>(), sum / 4.0, 1e-15);
  EXPECT_NEAR(all["sd"].get<double>(), std::sqrt(squares / 3.0), 1e-15);
  EXPECT_NEAR(all["confidence_95"].get<double>(), 3.182446305284263 * std::sqrt(squares / 3.0) / 2.0, 1e-12);
  EXPECT_EQ(json["statistics"]["set 2"]["phi"]["count"], 2);
  EXPECT_TRUE(fs::exists(folder_ / "box.ensemble.csv") && fs::exists(folder_ / "box.ensemble.md"));
  expect_as_when_run_alone();
}

TEST_F(Ensembles, AStoppedOneGoesOnAndEndsTheSame) {
  Options stop = options();
  stop.max_steps = 250;  // of 400 a pack
  EXPECT_EQ(make(stop), 75);
  Options go_on = options();
  go_on.restart = "auto";
  int code = 75;
  for (int turn = 0; turn < 4 && code == 75; ++turn) code = make(go_on);
  EXPECT_EQ(code, 0);
  EXPECT_EQ(table()["packs"].size(), 4U);
  expect_as_when_run_alone();
}

TEST_F(Ensembles, NothingIsOverwrittenUnasked) {
  EXPECT_EQ(make(options()), 0);
  EXPECT_EQ(make(options()), 2);
  Options file = options();
  file.restart = "some.hdf";
  EXPECT_EQ(make(file), 2);
  Options again = options();
  again.restart = "auto";
  EXPECT_EQ(make(again), 0) << "all packs are there: nothing is done, the table is written again";
}

TEST_F(Ensembles, APackThatFailsStopsNoOther) {
  if (comm_.rank() == 0) fs::create_directories(folder_ / "box_1_2.hdf" / "in_the_way");
  comm_.barrier();
  Options force = options();
  force.force = true;
  EXPECT_EQ(make(force), 5);
  const nlohmann::json json = table();
  EXPECT_EQ(json["packs"][1]["code"], 5);
  EXPECT_TRUE(json["packs"][1]["phi"].is_null());
  EXPECT_EQ(json["packs"][3]["code"], 0);
  EXPECT_EQ(json["statistics"]["all"]["phi"]["count"], 3);
}

}  // namespace
}  // namespace packmpi::run
