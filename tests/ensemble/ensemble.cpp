// Ensembles: each pack as when run alone, tables, stopping and going on, a pack that fails.
#include "ensemble/ensemble.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "disk/lock.hpp"
#include "input/read.hpp"
#include "pack/checkpoint.hpp"
#include "pack/pack.hpp"
#include "report/ensemble.hpp"
#include "report/json_seal.hpp"
#include "run/make_pack.hpp"

namespace packmpi::ensemble {
namespace {

using run::Options, run::make_pack;

namespace fs = std::filesystem;

const std::string scene_text =
    "[container]\nsize = [0.3, 0.3, 0.1]\n"
    "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e8\npoisson_ratio = 0.25\n"
    "radius = { distribution = \"equal\", value = 0.02 }\n"
    "[layers]\nthickness = 0.1\nfraction = 0.2\nduration = 0.02\nmaximum = 2\n[jamming]\ngravity = 2.0\n"
    "[dynamics]\ntime_step = 1.0e-4\n[rest]\nunbalanced_force = 1e9\nkinetic_energy = 1e9\nsupport = 1e9\nwait = "
    "0\n[ensemble]\nsets = 2\npacks = 2\n";

class Ensembles : public ::testing::Test {
 protected:
  const comm::Comm comm_{MPI_COMM_WORLD};
  const fs::path folder_ = fs::path(testing::TempDir()) / ("packmpi_ensemble_" + std::to_string(::getppid()));

  void SetUp() override {
    if (comm_.rank() == 0) fs::remove_all(folder_);
    comm_.barrier();
  }
  std::vector<std::string> changes_;  // of the scene, as --set
  mutable std::string words_, said_;  // of the last error, on the screen

  [[nodiscard]] input::Input scene() const { return input::parse(scene_text, "box.toml", {changes_}); }
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
      words_ = error.what();
    }
    said_ = testing::internal::GetCapturedStdout();
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
  EXPECT_EQ(all[3].seed, all[0].seed + 10001);
  input::Input last = scene();
  last.seed = 9223372036854775806ULL;
  EXPECT_THROW(static_cast<void>(members(last)), Error);
}

TEST_F(Ensembles, SeedsStayWhenItGrowsAndNoneComesTwice) {
  input::Input small = scene(), large = scene();
  large.ensemble = {.sets = 3, .packs = 4096};
  std::map<std::string, std::uint64_t> seeds;
  std::set<std::uint64_t> different;
  for (const Member& member : members(large)) {
    seeds[member.name] = member.seed;
    different.insert(member.seed);
  }
  EXPECT_EQ(different.size(), 3U * 4096U);
  for (const Member& member : members(small)) EXPECT_EQ(seeds.at(member.name), member.seed) << member.name;
  EXPECT_EQ(seeds.at("box_1_17"), small.seed + 16) << "those of one set are as they ever were";
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

TEST(Statistics, OfTooFewPacksAreUnknown) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const report::Statistics none = report::statistics({nan, nan}), one = report::statistics({0.6, nan});
  EXPECT_EQ(none.count, 0);
  EXPECT_TRUE(std::isnan(none.mean) && std::isnan(none.confidence));
  EXPECT_EQ(one.mean, 0.6);
  EXPECT_TRUE(std::isnan(one.sd) && std::isnan(one.variation) && std::isnan(one.confidence));
}

TEST_F(Ensembles, GrownItMakesWhatIsNewAndKeepsTheRest) {
  EXPECT_EQ(make(options()), 0);
  const pack::PackRows before = pack("box_2_1");
  const auto written = fs::last_write_time(folder_ / "box_2_1.hdf");
  comm_.barrier();
  changes_ = {"ensemble.packs=3"};
  Options go_on = options();
  go_on.restart = "auto";
  EXPECT_EQ(make(go_on), 0) << words_;
  EXPECT_EQ(table()["packs"].size(), 6U);
  EXPECT_EQ(fs::last_write_time(folder_ / "box_2_1.hdf"), written);
  EXPECT_EQ(pack("box_2_1").position, before.position);
  EXPECT_NE(pack("box_1_3").position, before.position);
  std::set<std::uint64_t> seeds;
  const nlohmann::json grown = table();
  for (const auto& row : grown["packs"]) seeds.insert(row["seed"].get<std::uint64_t>());
  EXPECT_EQ(seeds.size(), 6U);
  comm_.barrier();
  expect_as_when_run_alone();
}

// What stands under the right name and is not the pack of the scene is refused by its name, and never in a table.
TEST_F(Ensembles, WhatIsTakenOverIsLookedAt) {
  EXPECT_EQ(make(options()), 0);
  Options go_on = options();
  go_on.restart = "auto";
  const auto refused = [&](const std::string& name, const std::string& why) {
    comm_.barrier();
    if (comm_.rank() == 0) fs::remove(folder_ / "box.ensemble.json");
    comm_.barrier();
    EXPECT_EQ(make(go_on), 6) << words_;
    EXPECT_NE(words_.find(name), std::string::npos) << words_;
    EXPECT_NE(words_.find(why), std::string::npos) << words_;
    EXPECT_EQ(words_.find('\n'), std::string::npos) << words_;
    EXPECT_FALSE(fs::exists(folder_ / "box.ensemble.json"));
    comm_.barrier();
  };
  for (const char* change : {"contact.friction=0.1", "seed=2", "layers.maximum=3", "output.contacts=true"}) {
    changes_ = {change};
    const std::string key = std::string(change).substr(0, std::string(change).find('='));
    refused("box_1_1.hdf", key + ": ");
  }
  changes_ = {};
  const auto with = [&](const std::string& file, const std::function<void(const fs::path&)>& spoil,
                        const std::string& why) {
    comm_.barrier();
    const fs::path path = folder_ / file, kept = folder_ / "kept";
    if (comm_.rank() == 0) {
      fs::copy_file(path, kept);
      spoil(path);
    }
    refused(file, why);
    if (comm_.rank() == 0) fs::rename(kept, path);
    comm_.barrier();
  };
  with(
      "box_1_2.hdf", [](const fs::path& path) { fs::resize_file(path, fs::file_size(path) / 2); }, "seal");
  with(
      "box_2_2.hdf", [](const fs::path& path) { fs::resize_file(path, 0); }, "seal");
  nlohmann::ordered_json forged{{"achieved", 5}};
  forged["seal"] = {{"summary", report::hexadecimal(report::digest_of(forged))}};
  for (const std::string& text : {std::string("{}"), std::string(R"({"seal": "x"})"),
                                  std::string(R"({"seal": {"summary": 7}})"), forged.dump()}) {
    with(
        "box_2_1.json", [&](const fs::path& path) { std::ofstream(path) << text; }, "edited");
  }
  with(
      "box_2_1.json", [](const fs::path& path) { fs::resize_file(path, std::uintmax_t{65} << 20); }, "no summary");
  with(
      "box_2_1.json",
      [&](const fs::path& path) {
        fs::copy_file(folder_ / "box_2_2.json", path, fs::copy_options::overwrite_existing);
      },
      "not the summary of");
  with(
      "box_2_1.json",
      [](const fs::path& path) {
        std::ifstream in(path);
        std::string text{std::istreambuf_iterator<char>(in), {}};
        const std::size_t at = text.find("\"phi_bulk\": 0.") + 14;
        text[at] = text[at] == '9' ? '8' : '9';
        std::ofstream(path) << text;
      },
      "edited");
  EXPECT_EQ(make(go_on), 0) << words_;
  EXPECT_EQ(table()["packs"].size(), 4U);
}

TEST_F(Ensembles, ACodeIsKept) {
  changes_ = {"container.size=[0.3,0.3,0.4]"};  // two layers do not reach it
  EXPECT_EQ(make(options()), 3);
  Options go_on = options();
  go_on.restart = "auto";
  EXPECT_EQ(make(go_on), 3);
  const nlohmann::json kept = table();
  for (const auto& row : kept["packs"]) EXPECT_EQ(row["code"], 3);
  if (comm_.rank() == 0) {
    EXPECT_EQ(std::count(said_.begin(), said_.end(), '\n'), 1) << said_;
    EXPECT_NE(said_.find("all 4 packs of box are finished"), std::string::npos) << said_;
    fs::remove(folder_ / "box_1_1.hdf");
  }
  comm_.barrier();
  EXPECT_EQ(make(go_on), 3) << "one is made, three are kept";
}

TEST_F(Ensembles, LimitsHoldForTheWhole) {
  Options stop = options();
  stop.max_steps = 500;  // of 400 a pack: a group of ranks makes one and a quarter
  EXPECT_EQ(make(stop), 75);
  comm_.barrier();
  EXPECT_FALSE(fs::exists(folder_ / "box.ensemble.csv"));
  if (comm_.rank() == 0) {
    std::int64_t steps = 0, packs = 0;
    for (const Member& member : members(scene())) {
      packs += fs::exists(folder_ / (member.name + ".hdf")) ? 1 : 0;
      const fs::path slot = folder_ / (member.name + ".ckpt.A.hdf");
      if (fs::exists(slot)) steps += pack::read_state(slot.string()).progress.steps;
    }
    std::int64_t expected = 0;
    for (int group = 0; group < comm_.size(); ++group) {
      expected += std::min<std::int64_t>(500, 400 * ((4 - group + comm_.size() - 1) / comm_.size()));
    }
    EXPECT_EQ(steps + 400 * packs, expected) << packs << " packs";
    EXPECT_NE(words_.find("of 4 packs made"), std::string::npos) << words_;
  }
  comm_.barrier();
  Options hours = options();
  hours.restart = "auto";
  hours.max_hours = 1e-9;
  EXPECT_EQ(make(hours), 75);
  EXPECT_EQ(words_.find('\n'), std::string::npos) << words_;
}

// In short packs nobody looks for it once a second: between them somebody does.
TEST_F(Ensembles, AStopFileEndsItWithOneLine) {
  changes_ = {"ensemble.packs=16"};
  std::thread user([this] {
    if (comm_.rank() != 0) return;
    for (int turn = 0; turn < 3000 && !fs::exists(folder_ / "box_1_1.hdf"); ++turn) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    std::ofstream(folder_ / "STOP");
  });
  testing::internal::CaptureStderr();
  const int code = make(options());
  const std::string errors = testing::internal::GetCapturedStderr();
  user.join();
  EXPECT_EQ(code, 75);
  EXPECT_EQ(errors, "");
  EXPECT_EQ(words_.find('\n'), std::string::npos) << words_;
  comm_.barrier();
  EXPECT_FALSE(fs::exists(folder_ / "box.ensemble.json"));
  Options go_on = options();
  go_on.restart = "auto";
  EXPECT_EQ(make(go_on), 2) << "it is still there";
  EXPECT_NE(words_.find("STOP exists"), std::string::npos) << words_;
}

TEST_F(Ensembles, OneAtATimeInAFolder) {
  disk::Lock other;
  if (comm_.rank() == 0) {
    fs::create_directories(folder_);
    other = disk::Lock((folder_ / "box.lock").string());
  }
  comm_.barrier();
  for (const char* restart : {"", "auto"}) {
    for (const bool force : {false, true}) {
      Options second = options();
      second.restart = restart;
      second.force = force;
      EXPECT_EQ(make(second), 2);
      EXPECT_NE(words_.find("box.lock is held by process"), std::string::npos) << words_;
    }
  }
}

}  // namespace
}  // namespace packmpi::ensemble
