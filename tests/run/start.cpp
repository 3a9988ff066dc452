// Going on from a pack: to the bit where nothing is asked, more layers, another friction, and what does not fit.
#include "run/start.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>

#include "exporters/convert.hpp"
#include "geometry/volume.hpp"
#include "input/read.hpp"
#include "pack/pack.hpp"
#include "report/json_seal.hpp"
#include "run/analyze.hpp"
#include "run/make_pack.hpp"
#include "start/fit.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// Ten falls a layer: at rest.
const std::string base =
    "fidelity = \"balanced\"\n[container]\nsize = [0.3, 0.3, 0.08]\nboundary = [\"periodic\", \"periodic\"]\n"
    "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e7\npoisson_ratio = 0.25\n"
    "radius = { distribution = \"equal\", value = 0.02 }\n"
    "[layers]\nthickness = 0.1\nfraction = 0.2\n[jamming]\ngravity = 9.81\n[contact]\nfriction = 0.4\n"
    "[checkpoint]\nevery = \"off\"\n";

class Start : public ::testing::Test {
 protected:
  const comm::Comm comm_{MPI_COMM_WORLD};
  const fs::path folder_ = fs::path(testing::TempDir()) / ("packmpi_start_" + std::to_string(::getppid()));

  void SetUp() override {
    if (comm_.rank() == 0) fs::remove_all(folder_), fs::create_directories(folder_);
    comm_.barrier();
    (void)make("base", "", {});
  }
  report::RunRecord make(const std::string& name, const std::string& more, const std::vector<std::string>& set,
                         const std::function<void(Options&)>& change = {}) {
    Options o;
    o.folder = folder_.string();
    o.verbosity = log::Verbosity::quiet;
    o.force = true;
    if (change) change(o);
    const std::string path = (folder_ / (name + ".toml")).string();
    const scene::Scene scene = scene::build(start::with_start(comm_, input::parse(base + more, path, {set})));
    report::RunRecord record = make_pack(comm_, scene, o);
    comm_.barrier();
    return record;
  }
  report::RunRecord go_on(const std::vector<std::string>& set, const std::function<void(Options&)>& change = {}) {
    return make("next", "[start]\npack = \"base.hdf\"\n", set, change);
  }
  std::string complaint(const std::vector<std::string>& set) {
    try {
      (void)go_on(set);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input);
      return error.what();
    }
    return "";
  }
  [[nodiscard]] std::string analysis_of(const std::string& name) const {
    (void)analyze(comm_, (folder_ / (name + ".hdf")).string());
    comm_.barrier();
    std::ifstream file(folder_ / (name + ".analysis.json"));
    return {std::istreambuf_iterator<char>(file), {}};
  }
  [[nodiscard]] pack::PackRows rows(const std::string& name) const {
    return pack::read_pack((folder_ / (name + ".hdf")).string());
  }
};

void expect_equal(const pack::PackRows& a, const pack::PackRows& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.radius, b.radius);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.spin, b.spin);
  EXPECT_EQ(a.layer, b.layer);
  EXPECT_EQ(a.contacts, b.contacts);
}

TEST_F(Start, WithNothingAskedItIsEqualToTheBit) {
  const report::RunRecord record = go_on({});
  EXPECT_EQ(record.steps, 0);
  EXPECT_TRUE(record.targets_met) << ::testing::PrintToString(record.missed);
  expect_equal(rows("next"), rows("base"));
  const std::string digest = report::hexadecimal(pack::seal_of((folder_ / "base.hdf").string()));
  EXPECT_THAT(record.start, HasSubstr("base.hdf (digest " + digest + "): "));
  EXPECT_THAT(record.effective_input, HasSubstr("digest = \"" + digest + "\""));
  EXPECT_EQ(record.layers.front().stop_reason, "taken over");
}

// Short layers end in motion. What was taken over has no energy, and beside it theirs would seem to grow.
TEST_F(Start, EnergyGrowsFromTheLayersOfThisRun) {
  const report::RunRecord first = make("base", "", {"container.size=[0.3,0.3,0.12]"});
  ASSERT_GE(first.layers.size(), 3U);
  const report::RunRecord record =
      go_on({"container.size=[0.3,0.3,0.24]", "layers.duration=0.17", "layers.velocity=[0,0,0]"});
  ASSERT_GE(record.layers.size(), first.layers.size() + 3U);
  EXPECT_GT(record.layers.back().kinetic_per_mgd, 0.01);
}

// The springs of the contacts are in the pack: rest is the same as before, and is judged.
TEST_F(Start, WhatContactsRememberGoesOnIfThePackHasIt) {
  const report::RunRecord first = make("base", "", {"output.contacts=true"});
  const report::RunRecord record = go_on({"output.contacts=true"});
  EXPECT_EQ(record.steps, 0);
  expect_equal(rows("next"), rows("base"));
  EXPECT_THAT(record.start, HasSubstr("spins, what contacts remember; not taken over: time and counters"));
  ASSERT_GT(first.rest.unbalanced_force, 0.0);
  EXPECT_NEAR(record.rest.unbalanced_force, first.rest.unbalanced_force, 1e-9 * first.rest.unbalanced_force);
  EXPECT_NEAR(record.rest.support, first.rest.support, 1e-9);
  ASSERT_EQ(record.criteria.size(), first.criteria.size());
  for (std::size_t k = 0; k < first.criteria.size(); ++k) EXPECT_EQ(record.criteria[k].limit, first.criteria[k].limit);
  const auto springs = [&](const char* name, const report::RunRecord& of) {
    const scene::Scene scene = scene::build(input::parse(of.effective_input, "scene.toml", {}));
    return pack::histories_of(comm_, (folder_ / name).string(), scene);
  };
  const pack::Histories before = springs("base.hdf", first), after = springs("next.hdf", first);
  ASSERT_GT(comm_.sum(std::ssize(before.rows)), 0);
  ASSERT_EQ(before.rows.size(), after.rows.size());
  for (std::size_t k = 0; k < before.rows.size(); ++k) {
    ASSERT_EQ(before.rows[k].holder, after.rows[k].holder);
    ASSERT_EQ(before.rows[k].other, after.rows[k].other);
    for (std::size_t c = 0; c < before.rows[k].values.size(); ++c)
      EXPECT_NEAR(after.rows[k].values[c], before.rows[k].values[c], 1e-12 * first.mean_radius);
  }
}

TEST_F(Start, WithoutThemRestIsNotJudgedAndItSaysSo) {
  const report::RunRecord record = go_on({});
  EXPECT_THAT(record.start, HasSubstr("not taken over: what contacts remember, time and counters"));
  for (const report::Criterion& c : record.criteria) EXPECT_TRUE(c.met()) << c.words;
}

// packmpi analyze measures the rest of a pack as its run did, if the pack has the springs; else it says that it cannot.
TEST_F(Start, AnalyzeKnowsTheRestOfAPackWithSprings) {
  const auto analysed = [&] { return nlohmann::json::parse(analysis_of("base")); };
  EXPECT_TRUE(analysed().at("rest").at("unbalanced_force").is_null());
  const report::RunRecord first = make("base", "", {"output.contacts=true"});
  const nlohmann::json rest = analysed().at("rest");
  EXPECT_NEAR(rest.at("unbalanced_force").get<double>(), first.rest.unbalanced_force,
              1e-9 * first.rest.unbalanced_force);
  EXPECT_NEAR(rest.at("support").get<double>(), first.rest.support, 1e-9);
  EXPECT_EQ(rest.at("kinetic_energy").get<double>(), first.rest.kinetic_energy);
  EXPECT_EQ(rest.at("worst_overlap").get<double>(), first.rest.worst_overlap);
}

TEST_F(Start, GoesOnWithMoreLayers) {
  const pack::PackRows before = rows("base");
  const report::RunRecord record = go_on({"container.size=[0.3, 0.3, 0.14]"});
  EXPECT_TRUE(record.targets_met) << ::testing::PrintToString(record.missed);
  EXPECT_GE(record.height, 0.14);
  const pack::PackRows after = rows("next");
  ASSERT_GT(after.id.size(), before.id.size());
  EXPECT_TRUE(std::equal(before.radius.begin(), before.radius.end(), after.radius.begin()));
  EXPECT_TRUE(std::equal(before.layer.begin(), before.layer.end(), after.layer.begin()));
  EXPECT_EQ(record.layers[static_cast<std::size_t>(before.layer.back())].total, std::ssize(before.id));
  // As high as one made at once, of as many layers: the same names, so the same particles were inserted.
  const report::RunRecord once = make("once", "", {"container.size=[0.3, 0.3, 0.14]"});
  for (std::size_t k = 0; k < std::min(record.layers.size(), once.layers.size()); ++k)
    EXPECT_EQ(record.layers[k].inserted, once.layers[k].inserted) << k;
  EXPECT_NEAR(record.phi_bulk, once.phi_bulk, 0.02) << "a few hundred spheres";
}

TEST_F(Start, AStoppedRunNeedsNoSecondStart) {
  (void)go_on({"container.size=[0.3, 0.3, 0.14]"});
  const pack::PackRows target = rows("next");
  EXPECT_THROW((void)go_on({"container.size=[0.3, 0.3, 0.14]"}, [](Options& o) { o.max_steps = 100; }),
               comm::AgreedError);
  const report::RunRecord record = go_on({"container.size=[0.3, 0.3, 0.14]"}, [](Options& o) {
    o.force = false;
    o.restart = "auto";
  });
  EXPECT_THAT(record.start, HasSubstr("taken over"));
  expect_equal(rows("next"), target);
}

// A lid, a number of particles: asked for in the scene that goes on, and met.
TEST_F(Start, ALidPressesWhatWasTakenOver) {
  const report::RunRecord record = go_on({"confinement.vertical=500"});
  EXPECT_TRUE(record.targets_met) << ::testing::PrintToString(record.missed);
  EXPECT_GT(record.steps, 0);
  EXPECT_EQ(rows("next").radius, rows("base").radius) << "no layer was added";
}

TEST_F(Start, ALidIsLeftBehindWithWhatTouchedIt) {
  const report::RunRecord pressed = make("base", "[confinement]\nvertical = 500.0\n", {"output.contacts=true"});
  EXPECT_GT(pressed.confined.on_lid, 0.0);
  EXPECT_NO_THROW((void)go_on({}));
}

TEST_F(Start, ANumberCountsWhatWasTakenOver) {
  const std::int64_t there = std::ssize(rows("base").id);
  const report::RunRecord record = go_on({fmt::format("particles.count={}", there + 25)});
  EXPECT_TRUE(record.reached);
  EXPECT_EQ(record.particles, there + 25);
  EXPECT_EQ(go_on({fmt::format("particles.count={}", there)}).steps, 0);
  EXPECT_THAT(complaint({fmt::format("particles.count={}", there - 1)}),
              HasSubstr(fmt::format(": particles.count: is {}, and base.hdf has {}; raise it, or remove it", there - 1,
                                    there)));
}

// Of a pack that was periodic a box is cut out with `convert --cut`, and more layers come on top of it between walls.
TEST_F(Start, GoesOnFromACut) {
  const std::string cut = (folder_ / "part.csv").string();
  const exporters::Converted part = exporters::convert_pack(comm_, {.pack = (folder_ / "base.hdf").string(),
                                                                    .format = "csv",
                                                                    .file = cut,
                                                                    .cut = "box:length=0.2,width=0.24",
                                                                    .force = true});
  ASSERT_GT(part.particles, 10);
  const report::RunRecord record =
      make("next", "[start]\npack = \"part.csv\"\n",
           {"container.size=[0.2, 0.24, 0.12]", "container.boundary=[\"wall\", \"wall\"]"});
  EXPECT_TRUE(record.targets_met) << ::testing::PrintToString(record.missed);
  EXPECT_EQ(record.layers.front().total, part.particles);
  EXPECT_GT(record.particles, part.particles);
  EXPECT_GE(record.height, 0.12);
}

std::vector<double> radii_of(const pack::PackRows& rows, std::int32_t component) {
  std::vector<double> radii;
  for (std::size_t k = 0; k < rows.id.size(); ++k) {
    if (rows.component[k] == component) radii.push_back(rows.radius[k]);
  }
  return radii;
}

// Two components: each particle keeps its own, what comes on top has the shares of the scene that goes on.
TEST_F(Start, GoesOnWithComponents) {
  const auto with = [](double heavy, double light, const char* second) {
    return fmt::format(
        "[mixture]\nshare_by = \"mass\"\n[[component]]\nname = \"heavy\"\nshare = {}\ndensity = 2000\n[[component]]\n"
        "name = \"{}\"\nshare = {}\nradius = {{ distribution = \"uniform\", weighting = \"mass\", min = 0.015, max = "
        "0.018 }}\n",
        heavy, second, light);
  };
  const std::string pack = "[start]\npack = \"both.hdf\"\n";
  const report::RunRecord first = make("both", with(0.5, 0.5, "light"), {"output.contacts=true"});
  const pack::PackRows before = rows("both");
  EXPECT_EQ(make("next", with(0.5, 0.5, "light") + pack, {"output.contacts=true"}).steps, 0);
  expect_equal(rows("next"), before);
  EXPECT_EQ(rows("next").component, before.component);
  // Of each component the same particles, one after the other, as made at once.
  const std::vector<std::string> higher{"container.size=[0.3, 0.3, 0.14]"};
  (void)make("next", with(0.5, 0.5, "light") + pack, higher);
  (void)make("once", with(0.5, 0.5, "light"), higher);
  const std::vector<double> further = radii_of(rows("next"), 1), once = radii_of(rows("once"), 1);
  ASSERT_GT(further.size(), radii_of(before, 1).size());
  EXPECT_TRUE(
      std::equal(further.begin(), further.begin() + std::min(std::ssize(further), std::ssize(once)), once.begin()));
  const report::RunRecord record = make("next", with(0.2, 0.8, "light") + pack, higher);
  EXPECT_TRUE(record.targets_met) << ::testing::PrintToString(record.missed);
  const pack::PackRows after = rows("next");
  ASSERT_GT(after.id.size(), before.id.size());
  EXPECT_TRUE(std::equal(before.component.begin(), before.component.end(), after.component.begin()));
  double heavy = 0.0, all = 0.0, largest = 0.0;
  for (std::size_t k = before.id.size(); k < after.id.size(); ++k) {
    const bool is_heavy = after.component[k] == 0;
    const double mass = (is_heavy ? 2000.0 : 1000.0) * geometry::volume(3, after.radius[k]);
    all += mass;
    if (is_heavy) heavy += mass, largest = std::max(largest, mass);
  }
  EXPECT_NEAR(heavy, 0.2 * all, largest) << "of the new layers";
  EXPECT_GT(record.layers.size(), first.layers.size());
  const auto complaint_of = [&](const std::string& text) {
    try {
      (void)make("next", text, {});
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(complaint_of(with(0.5, 0.5, "other") + pack),
              HasSubstr("start.pack: is of the components heavy, light, the scene of the components heavy, other; give "
                        "those of the pack"));
  EXPECT_THAT(complaint_of(pack),
              HasSubstr("start.pack: is of the components heavy, light, the scene of one material"));
}

TEST_F(Start, UnderOtherForcesItComesToRestAgain) {
  const report::RunRecord record = go_on({"contact.friction=0.1"});
  EXPECT_GT(record.steps, 0);
  EXPECT_EQ(record.layers.size(), make("base", "", {}).layers.size()) << "no layer was added";
}

TEST_F(Start, ACheckTellsWhatARunWould) {
  const auto next = [&](const std::string& set) {
    const std::string path = (folder_ / "next.toml").string();
    const input::Input in = input::parse(base + "[start]\npack = \"base.hdf\"\n", path, {{set}});
    return scene::build(start::with_start(comm_, in));
  };
  EXPECT_NO_THROW(check_start(comm_, next("seed=1")));
  EXPECT_THROW(check_start(comm_, next("start.overlap_limit=1e-9")), Error);
  EXPECT_THROW(check_start(comm_, next("container.size=[0.4, 0.3, 0.1]")), Error);
}

TEST_F(Start, WhatDoesNotFitIsRefused) {
  const std::string next = (folder_ / "next.toml").string() + ": start.pack: ";
  EXPECT_EQ(complaint({"container.size=[0.4, 0.3, 0.1]"}),
            next +
                "is in a container of 0.3 m along x with boundary \"periodic\", the scene in one of 0.4 m with "
                "\"periodic\"; give that of the pack");
  EXPECT_EQ(complaint({"container.boundary=[\"periodic\", \"wall\"]"}),
            next +
                "is in a container of 0.3 m along y with boundary \"periodic\", the scene in one of 0.3 m with "
                "\"wall\"; give that of the pack");
  EXPECT_EQ(complaint({"particles.radius.value=0.019"}),
            next +
                "its radii are 0.02 to 0.02 m, those of the scene 0.019 to 0.019 m; give particles.radius a range "
                "that has both");
  EXPECT_THAT(complaint({"start.overlap_limit=1e-9"}),
              HasSubstr("; start.overlap_limit is 1e-09: raise that, or give a pack that is at rest"));
  EXPECT_THAT(complaint({"start.digest=0123456789abcdef"}),
              HasSubstr(": start.digest: is 0123456789abcdef, and base.hdf has "));
  EXPECT_THROW((void)go_on({"start.pack=no.hdf"}), Error);
}

}  // namespace
}  // namespace packmpi::run
