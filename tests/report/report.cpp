#include "report/report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "disk/text_file.hpp"
#include "pack/samples.hpp"
#include "report/step_log.hpp"

namespace packmpi::report {
using namespace disk;
using namespace pack;
namespace {

using testing::Folder;

class Report : public ::testing::Test {
 protected:
  comm::Comm comm_{MPI_COMM_WORLD};
  Folder folder_{comm_};

  [[nodiscard]] std::string read(const std::string& name) const {
    comm_.barrier();
    std::ifstream file(folder_.file(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(Report, JsonGivesEveryNumberBack) {
  const RunRecord record = testing::some_record(3, 4);
  const auto json = nlohmann::json::parse(to_json(record));
  EXPECT_EQ(json["target"]["target_height"].get<double>(), record.target_height);
  EXPECT_EQ(json["target"]["size"].get<std::vector<double>>(), (std::vector<double>{1.0, 2.0, 0.5}));
  EXPECT_EQ(json["achieved"]["phi"].get<double>(), 0.1 + 0.2);
  EXPECT_EQ(json["achieved"]["porosity"].get<double>(), 1.0 - (0.1 + 0.2));
  EXPECT_EQ(json["achieved"]["void_ratio"].get<double>(), (1.0 - (0.1 + 0.2)) / (0.1 + 0.2));
  EXPECT_EQ(json["achieved"]["porosity_bulk"].get<double>(), 1.0 - record.phi_bulk);
  EXPECT_EQ(json["achieved"]["height"].get<double>(), 0.512345678901234);
  EXPECT_EQ(json["achieved"]["particles"].get<std::int64_t>(), 1234567890123);
  EXPECT_EQ(json["achieved"]["reached"].get<bool>(), true);
  EXPECT_EQ(json["audit"]["lost"].get<std::int64_t>(), 0);
  EXPECT_EQ(json["provenance"]["seed"].get<std::uint64_t>(), record.seed);
  EXPECT_EQ(json["provenance"]["effective_input"].get<std::string>(), record.effective_input);
  ASSERT_EQ(json["layers"].size(), 4u);
  EXPECT_EQ(json["layers"][3]["inserted"].get<std::int64_t>(), 1000000003);
  EXPECT_EQ(json["layers"][1]["stop_reason"].get<std::string>(), "settled");
  EXPECT_EQ(json["rest"]["support"]["value"].get<double>(), 0.99);
  EXPECT_EQ(json["rest"]["support"]["target"].get<double>(), 1.0);
  EXPECT_EQ(json["rest"]["support"]["limit"].get<double>(), 0.02);
  EXPECT_TRUE(json["rest"]["support"]["met"].get<bool>());
  EXPECT_FALSE(json["rest"]["unbalanced_force"]["met"].get<bool>());
  EXPECT_EQ(json["missed"].get<std::vector<std::string>>(), record.missed);
  EXPECT_EQ(json["units"]["phi"].get<std::string>(), "-");
  EXPECT_EQ(json["units"]["floor_force"].get<std::string>(), "N");
}

TEST_F(Report, JsonOfABrokenRunStillParses) {
  RunRecord record = testing::some_record(2, 1);
  record.phi = std::numeric_limits<double>::quiet_NaN();
  record.layers[0].height = std::numeric_limits<double>::infinity();
  record.name = "not UTF-8: \xff";
  const auto json = nlohmann::json::parse(to_json(record));
  EXPECT_TRUE(json["achieved"]["phi"].is_null());
  EXPECT_TRUE(json["layers"][0]["height"].is_null());
  EXPECT_EQ(json["target"]["size"].size(), 2u);
}

TEST_F(Report, TableFitsAScreenAndIsAligned) {
  RunRecord record = testing::some_record(3, 12);
  record.name = std::string(300, 'n');
  record.stop_reason = std::string(300, 's');
  record.layers[3].stop_reason = std::string(300, 's');
  record.compaction_rate = -std::numeric_limits<double>::denorm_min();
  record.steps = record.particle_steps = std::numeric_limits<std::int64_t>::max();
  record.layers[5].kinetic_per_mgd = 1.23456e-300;
  record.layers[5].height = -1.23456e-300;
  std::istringstream lines(to_table(record));
  std::string line;
  std::size_t count = 0;
  std::size_t quantity_end = 0;
  while (std::getline(lines, line)) {
    EXPECT_LE(line.size(), 100u) << line;
    if (line.find("target") != std::string::npos && quantity_end == 0) quantity_end = line.size();
    if (count >= 1 && count <= 29) {
      EXPECT_EQ(line.size(), quantity_end) << line;
    }
    ++count;
  }
  EXPECT_EQ(count, 1u + 29u + 1u + 12u);
}

RunRecord counted_record(std::int64_t big) {
  RunRecord record = testing::some_record(3, 1);
  record.counters = {{"owned", "", {10, 20, 30}},
                     {"ghost_messages", "", {0, 0, 0}},
                     {"ghost_bytes", "B", {big, 0, 0}},
                     {"particle_steps", "", {50, 0, 25}},
                     {"frozen_steps", "", {0, 25, 0}}};
  record.costs = {{"waiting", "ns", {1500000000, 0, 0}}, {"memory", "B", {2000000, 3000000, 1000000}}};
  return record;
}

TEST_F(Report, CountersOfAllRanks) {
  constexpr std::int64_t big = std::numeric_limits<std::int64_t>::max();
  const RunRecord record = counted_record(big);
  const auto json = nlohmann::json::parse(to_json(record));
  EXPECT_EQ(json["counters"]["owned"]["sum"].get<std::int64_t>(), 60);
  EXPECT_EQ(json["counters"]["owned"]["max"].get<std::int64_t>(), 30);
  EXPECT_EQ(json["counters"]["owned"]["max_over_mean"].get<double>(), 1.5);
  EXPECT_EQ(json["counters"]["owned"]["of_rank"].get<std::vector<std::int64_t>>(),
            (std::vector<std::int64_t>{10, 20, 30}));
  EXPECT_EQ(json["counters"]["ghost_messages"]["max_over_mean"].get<double>(), 1.0);
  EXPECT_EQ(json["counters"]["ghost_bytes"]["unit"].get<std::string>(), "B");
  EXPECT_EQ(json["costs"]["waiting"]["unit"].get<std::string>(), "ns");
  EXPECT_EQ(json["moving_share"].get<double>(), 0.75);
  const std::string table = to_table(record);
  const std::string counted = table.substr(table.find("counted on 3 ranks"));
  EXPECT_NE(counted.find("9223372036854775807"), std::string::npos);
  EXPECT_NE(counted.find("waiting [s]"), std::string::npos);
  EXPECT_NE(counted.find("1.500"), std::string::npos);
  EXPECT_NE(counted.find("moving share of the particles 0.7500"), std::string::npos);
  EXPECT_EQ(counted.find("ghost messages"), std::string::npos);  // of what was none, no row
  std::istringstream lines(counted);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100U) << line;
}

TEST_F(Report, TableShowsAskedBesideGot) {
  const std::string table = to_table(testing::some_record(3, 1));
  const auto row = table.substr(table.find("height [m]"));
  EXPECT_NE(row.substr(0, row.find('\n')).find("0.5 "), std::string::npos) << row;
  EXPECT_NE(row.substr(0, row.find('\n')).find("0.51235"), std::string::npos) << row;
}

// Of a pack that was filled to its density and then confined, the density asked for stands beside the one it is for.
TEST(Lines, SayWhichDensityWasAskedFor) {
  RunRecord record;
  record.phi_bulk = 0.6281;
  record.density.key = "target.solid_fraction";
  record.density.fraction = 0.62;
  record.density.tolerance = 0.002;
  EXPECT_NE(to_lines(record, {}).find("in the bulk; asked 0.62 +- 0.002\n"), std::string::npos);
  record.confined.on = true;
  record.confined.phi_before = 0.6198;
  EXPECT_NE(to_lines(record, {}).find("asked 0.62 +- 0.002 before the lid, when it was 0.6198\n"), std::string::npos);
  record.density.confined = true;
  EXPECT_NE(to_lines(record, {}).find("in the bulk; asked 0.62 +- 0.002\n"), std::string::npos);
}

TEST_F(Report, LinesSayWhatAUserLooksFor) {
  RunRecord record = testing::some_record(3, 2);
  record.missed = {"rest.support: too little", "container.size: too low"};
  record.stop_reason = "height";
  const std::string lines = to_lines(record, {"out/bed.hdf", "out/bed.json", "elsewhere/bed.log"});
  for (const char* words :
       {"finished; missed: rest.support, container.size\n", "1234567890123 in 1 x 2 x 0.5 m",
        "  height    512.3 mm; asked 500 mm\n", "porosity n ", "void ratio e ", "ended by height\n",
        "unbalanced force ", "of the weight borne", "  pack      out/bed.hdf; beside it .json, elsewhere/bed.log\n"}) {
    EXPECT_NE(lines.find(words), std::string::npos) << words << "\n" << lines;
  }
  EXPECT_LE(std::count(lines.begin(), lines.end(), '\n'), 11) << lines;
  record.missed.clear();
  record.insertion_alone = true;
  record.target_min_radius = record.target_max_radius = record.mean_radius = 2e-5;
  const std::string placed = to_lines(record, {});
  EXPECT_NE(placed.find("done, all targets met\n"), std::string::npos) << placed;
  EXPECT_NE(placed.find("  diameter  40 µm\n"), std::string::npos) << placed;
  for (const char* word : {"rest", "height  ", "contacts", "pack  "}) {
    EXPECT_EQ(placed.find(word), std::string::npos) << word << "\n" << placed;  // nothing moved, nothing was written
  }
}

TEST_F(Report, TextIsWrittenWhole) {
  const std::string text = "one\ntwo" + std::string(100000, 'x');
  write_text(comm_, folder_.file("a.json"), "short");
  write_text(comm_, folder_.file("a.json"), text);
  EXPECT_EQ(read("a.json"), text);
  EXPECT_EQ(read("a.json.tmp"), "");
}

TEST_F(Report, StepLogIsATable) {
  SeriesMark mark;
  StepLog log(comm_, folder_.file("a.csv"), mark, false);
  log.append({.layer = 0,
              .step = 100,
              .time = 0.01,
              .particles = 1234567890123,
              .kinetic_energy = 1.5,
              .max_speed = 0.25,
              .top = 0.5,
              .mean_height = 0.125,
              .max_force = 3.0,
              .rebuilds = 7,
              .moving = 11,
              .rotational_energy = 0.5,
              .potential_energy = 2.0,
              .elastic_energy = 0.75,
              .dissipated = 4.0,
              .momentum = {1.0, 2.0, -3.0}});
  log.append({.layer = 1, .step = 200, .time = 0.02, .particles = 5});
  EXPECT_NE(read("a.csv").find("0,100,0.01,1234567890123,1.5,0.25,0.5,0.125,3,7,11,0.5,2,0.75,4,1,2,-3\n"),
            std::string::npos);  // before close()
  EXPECT_EQ(log.close(), 2);
  const std::string text = read("a.csv");
  EXPECT_EQ(
      text.substr(0, text.find('\n')),
      "layer,step,time [s],particles,kinetic energy [J],max speed [m/s],top [m],mean height [m],max force "
      "[N],rebuilds,moving,rotational energy [J],potential energy [J],elastic energy [J],dissipated [J],momentum x "
      "[kg m/s],momentum y [kg m/s],momentum z [kg m/s]");
  EXPECT_NE(text.find("\n1,200,0.02,5,0,0,0,0,0,0,0,0,0,0,0,0,0,0\n"), std::string::npos);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 3);
}

}  // namespace
}  // namespace packmpi::report
