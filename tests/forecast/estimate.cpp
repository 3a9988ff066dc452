// What `packmpi estimate` tells, against a pack that is made, against the loop itself, and against its own inverse.
#include "forecast/estimate.hpp"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "disk/sealed_file.hpp"
#include "forecast/advice.hpp"
#include "forecast/limits.hpp"
#include "input/read.hpp"
#include "pack/checkpoint.hpp"
#include "pack/pack.hpp"
#include "run/make_pack.hpp"
#include "run/settle.hpp"
#include "scene/expectation.hpp"
#include "scene/ownership.hpp"

namespace packmpi::forecast {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Set = std::vector<std::string>;

const char* const brick = R"(
[container]
size = [0.3, 0.2, 0.3]
boundary = ["periodic", "periodic"]
[particles]
density = 1000.0
youngs_modulus = 1e7
poisson_ratio = 0.25
radius = { distribution = "equal", value = 0.02 }
[layers]
thickness = 0.1
fraction = 0.22
duration = 0.4
[jamming]
gravity = 5.0
[contact]
damping_ratio = 0.3
[rest]
wait = 0.0   # of other scenes than that of a final stage until rest
)";

class Estimates : public ::testing::Test {
 protected:
  const comm::Comm comm_{MPI_COMM_WORLD};
  fs::path folder_;

  void SetUp() override {
    const fs::path here = fs::temp_directory_path() / ("packmpi_estimate_" + std::to_string(::getpid()));
    folder_ = comm_.broadcast(0, here.string());
    if (comm_.rank() == 0) {
      fs::create_directories(folder_);
      std::ofstream(folder_ / "brick.toml") << brick;
    }
    comm_.barrier();
  }
  void TearDown() override {
    comm_.barrier();
    if (comm_.rank() == 0) fs::remove_all(folder_);
    comm_.barrier();
  }

  /// Of the pack there is, with so many between particles.
  [[nodiscard]] pack::ContactCounts counts_of(std::int64_t pairs, const Set& set) const {
    const disk::SealedFile file(folder_ / "brick.hdf");
    const auto walls = static_cast<std::int64_t>(file.extent<std::int64_t>("/wall_contacts/particle").at(0));
    EXPECT_GT(walls, 0);
    return {.pairs = pairs, .walls = walls, .features = scene(set).features};
  }
  [[nodiscard]] run::Options options(const Set& set = {}) const {
    run::Options options;
    options.scene = folder_ / "brick.toml";
    options.folder = folder_;
    options.overrides.set = set;
    options.force = true;
    options.verbosity = log::Verbosity::quiet;
    return options;
  }
  [[nodiscard]] report::Estimate of(const Question& question, const Set& set = {}) const {
    const run::Options asked = options(set);
    return estimate(comm_, asked.scene, asked.overrides, question);
  }
  [[nodiscard]] scene::Scene scene(const Set& set) const {
    return scene::build(input::read(comm_, folder_ / "brick.toml", {set}));
  }
  /// The words of the error, which is one line.
  [[nodiscard]] std::string refusal(const Question& question, const Set& set = {}) const {
    try {
      (void)of(question, set);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input);
      return error.what();
    }
    return "no error";
  }
};

/// The changes of the scene that an estimate proposes.
Set proposed(const report::Estimate& e) {
  std::string size;
  for (const double side : e.size) size += fmt::format("{}{}", size.empty() ? "" : ",", side);
  return {fmt::format("container.size=[{}]", size), fmt::format("layers.thickness={}", e.layer_thickness)};
}

Question without_probe(Question question) {
  question.probe = false;
  return question;
}

// The whole way: a number of particles, the scene for it, the pack.
TEST_F(Estimates, APackIsWhatWasEstimated) {
  const report::Estimate e = of(without_probe({.particles = 300}));
  const report::RunRecord record = run::make_pack(comm_, scene(proposed(e)), options());
  EXPECT_EQ(std::ssize(record.layers), e.layers.value);
  EXPECT_EQ(record.layers.front().inserted, e.a_layer) << "exact for equal radii";
  EXPECT_LE(std::abs(record.particles - 300), e.layers.value);
  EXPECT_EQ(record.steps, e.steps);
  EXPECT_EQ(record.particle_steps, e.particle_steps);
  EXPECT_NEAR(record.duration, e.duration, 1e-9);
  EXPECT_NEAR(record.height, e.height, 0.06 * e.height);
  const auto pack = static_cast<double>(fs::file_size(folder_ / "brick.hdf"));
  EXPECT_NEAR(static_cast<double>(e.pack_bytes), pack, 0.02 * pack);
  EXPECT_EQ(pack::pack_bytes(record, true, record.particles, std::nullopt, observe::map_columns(scene(proposed(e)))),
            static_cast<std::int64_t>(pack));
}

TEST_F(Estimates, CheckpointsAndContactsAreAsLong) {
  const Set set{"container.size=[0.5,0.5,0.06]", "layers.thickness=0.3", "layers.duration=0.1", "output.contacts=true"};
  run::Options asked = options();
  asked.max_steps = 20;
  EXPECT_THROW((void)run::make_pack(comm_, scene(set), asked), Error);
  const std::string path = folder_ / "brick.ckpt.A.hdf";
  const auto bytes = static_cast<std::int64_t>(fs::file_size(path));
  EXPECT_EQ(pack::checkpoint_bytes(particles::layout_of(3, true), pack::read_state(path)), bytes);
  const report::Estimate e = of(without_probe({}), set);
  ASSERT_EQ(e.layers.value, 1);
  EXPECT_NEAR(static_cast<double>(e.checkpoint_bytes), static_cast<double>(bytes), 0.02 * static_cast<double>(bytes));
  const report::RunRecord record = run::make_pack(comm_, scene(set), options());
  const std::int64_t contacts =
      std::llround(0.5 * record.rest.network.coordination * static_cast<double>(record.particles));
  EXPECT_GT(contacts, 0);
  EXPECT_EQ(
      pack::pack_bytes(record, true, record.particles, counts_of(contacts, set), observe::map_columns(scene(set))),
      static_cast<std::int64_t>(fs::file_size(folder_ / "brick.hdf")));
}

TEST_F(Estimates, PacksOfContactsThatRememberAreAsLong) {
  const Set set{"container.size=[0.5,0.5,0.06]", "layers.thickness=0.3",       "layers.duration=0.1",
                "output.contacts=true",          "contact.tangential=mindlin", "contact.rolling_friction=0.1"};
  const report::RunRecord record = run::make_pack(comm_, scene(set), options());
  const std::int64_t contacts =
      std::llround(0.5 * record.rest.network.coordination * static_cast<double>(record.particles));
  EXPECT_EQ(
      pack::pack_bytes(record, true, record.particles, counts_of(contacts, set), observe::map_columns(scene(set))),
      static_cast<std::int64_t>(fs::file_size(folder_ / "brick.hdf")));
}

TEST_F(Estimates, EveryQuestionIsTheOthersAnswer) {
  for (const Set& given :
       {Set{}, Set{"container.dimension=2", "container.size=[0.5,0.4]", "container.boundary=[\"wall\"]"},
        Set{"particles.radius={distribution=\"uniform\",weighting=\"mass\",min=0.01,max=0.02}",
            "container.boundary=[\"wall\",\"periodic\"]"}}) {
    const std::int64_t wanted = 5000;
    const report::Estimate tall = of(without_probe({.particles = wanted}), given);
    EXPECT_EQ(tall.found, "height");
    EXPECT_LE(std::abs(tall.particles.value - wanted), tall.layers.value);
    Set with = given;
    for (const std::string& set : proposed(tall)) with.push_back(set);
    const report::Estimate back = of(without_probe({}), with);
    EXPECT_EQ(back.found, "particles");
    EXPECT_EQ(back.particles.value, tall.particles.value);
    EXPECT_EQ(back.layers.value, tall.layers.value);

    const double height = 0.7;
    const report::Estimate wide = of(without_probe({.particles = wanted, .height = height}), given);
    EXPECT_EQ(wide.found, "floor");
    EXPECT_EQ(wide.size.back(), height);
    EXPECT_LE(std::abs(wide.particles.value - wanted), wide.layers.value + wanted / 500) << "in whole layers";
    if (wide.size.size() == 3) {
      EXPECT_NEAR(wide.size[0] / wide.size[1], 1.5, 1e-9) << "of the scene's shape";
    }
  }
}

TEST_F(Estimates, NothingIsWritten) {
  const auto files = [&] {
    return std::distance(fs::directory_iterator(fs::current_path()), fs::directory_iterator()) +
           std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  };
  const auto before = files();
  comm_.barrier();
  EXPECT_GT(of(without_probe({})).pack_bytes, 0);
  comm_.barrier();
  EXPECT_EQ(files(), before);
}

TEST_F(Estimates, OneSideIsFound) {
  const report::Estimate e = of(without_probe({.particles = 2000, .height = 0.4, .sides = {0.25, std::nullopt}}));
  EXPECT_EQ(e.size[0], 0.25);
  EXPECT_LE(std::abs(e.particles.value - 2000), e.layers.value);
  const report::Estimate other = of(without_probe({.particles = 2000, .sides = {std::nullopt, 0.25}}));
  EXPECT_EQ(other.size[1], 0.25);
  EXPECT_EQ(other.size[2], 0.3) << "the scene's height";
}

TEST_F(Estimates, StepsOfTheMovingParticlesAreThoseOfTheLoop) {
  for (const int window : {0, 2, 50}) {
    const scene::Scene s = scene({"dynamics.window=" + std::to_string(window), "dynamics.relaxation=0.2",
                                  "dynamics.time_step=1e-4", "layers.time_step=2e-4"});
    std::int64_t steps = 0;
    for (std::int64_t layer = 1; layer <= 7; ++layer)
      steps += 2000 * 10 * (window > 0 ? std::min<std::int64_t>(window, layer) : layer);
    EXPECT_EQ(particle_steps_of(s, 7, 10), steps + 2000 * 70) << window;
  }
}

// A prism is a mesh that ends at H_d, wherever that is; its layers are those of the scene.
TEST_F(Estimates, APrismIsAsHighAsItsParticlesWant) {
  const std::string path = (folder_ / "prism.toml").string();
  if (comm_.rank() == 0) {
    std::ofstream(path) << "[container]\nshape = \"prism\"\npolygon = [[0, 0], [0.25, 0], [0.2, 0.2], [0.05, 0.22]]\n"
                           "height = 0.1\n[particles]\ndensity = 1000\nyoungs_modulus = 1e7\npoisson_ratio = 0.25\n"
                           "radius = { distribution = \"equal\", value = 0.005 }\n[layers]\nthickness = 0.05\n"
                           "fraction = 0.25\n[jamming]\ngravity = 9.81\n[contact]\nfriction = 0.3\n";
  }
  comm_.barrier();
  for (const std::int64_t wanted : {300, 2000, 5000, 20000}) {
    const report::Estimate e = forecast::estimate(comm_, path, {}, without_probe({.particles = wanted}));
    EXPECT_NEAR(static_cast<double>(e.particles.value), static_cast<double>(wanted),
                0.01 * static_cast<double>(wanted));
    EXPECT_THAT(report::to_table(e), HasSubstr("container.height = "));
  }
}

// Particles that are placed and not moved fill the container as far as layers.fraction says.
TEST_F(Estimates, InsertionAloneGetsItsHeightAndItsFloor) {
  const input::Input in = input::parse(
      "[container]\nsize = [0.1, 0.1, 0.1]\n[particles]\ndensity = 2650\nyoungs_modulus = 1e8\npoisson_ratio = 0.2\n"
      "radius = { distribution = \"equal\", value = 0.005 }\n[layers]\nduration = 0\nfraction = 0.1\n",
      "placed.toml", {});
  const double volume = 1000 * std::numbers::pi / 6.0 * 1e-6 / 0.1;
  const auto size_of = [&](const forecast::Question& question) { return forecast::estimate(comm_, in, question).size; };
  EXPECT_NEAR(size_of(without_probe({.particles = 1000})).back(), volume / 0.01, 1e-9);
  EXPECT_NEAR(size_of(without_probe({.particles = 1000, .height = 0.2})).front(), std::sqrt(volume / 0.2), 1e-9);
}

// Beyond dynamics.relaxation, which "draft" gives for a start only: without, less than half of the steps were foretold.
TEST_F(Estimates, TheFinalStageLastsUntilTheBedIsAtRest) {
  Set set{"fidelity=\"draft\"", "contact.tangential=\"mindlin\"", "rest.wait=\"auto\""};
  const report::Estimate e = of(without_probe({.particles = 600}), set);
  const Set size = proposed(e);
  set.insert(set.end(), size.begin(), size.end());
  const scene::Scene s = scene(set);
  ASSERT_GT(s.wait, 0.0);
  EXPECT_GT(e.relaxation_steps, 3 * run::steps_of(s, run::Part::relaxation));
  const report::RunRecord record = run::make_pack(comm_, s, options(set));
  EXPECT_NEAR(static_cast<double>(record.particle_steps) / static_cast<double>(e.particle_steps), 1.0, 0.4);
  const scene::Scene patient = scene({"fidelity=\"balanced\"", "contact.tangential=\"mindlin\"", "rest.wait=\"auto\""});
  const std::int64_t own = run::steps_of(patient, run::Part::relaxation);
  EXPECT_EQ(particle_steps_of(patient, 1, 1), run::steps_of(patient, run::Part::layer) + own) << "longer than that";
}

// Layers that end at H_d: what fits below it, and the height and the floor for as many.
// A lid on discs takes 0.5 to 1.5 times as long by its seed, one on spheres 0.8 to 1.2 times.
TEST_F(Estimates, StepsUnderAStressAreForetold) {
  for (const char* name : {"confined_isotropic", "confined_k0", "confined_cylinder", "confined_2d"}) {
    run::Options asked = options();
    asked.scene = fs::path(PACKMPI_SOURCE_DIR) / "tests" / "scenes" / (std::string(name) + ".toml");
    const report::Estimate e = estimate(comm_, asked.scene, {}, without_probe({}));
    const report::RunRecord record = run::make_pack(comm_, scene::build(input::read(comm_, asked.scene, {})), asked);
    ASSERT_GT(record.confined.steps, 0);
    const double told = static_cast<double>(e.confinement_steps) / static_cast<double>(record.confined.steps);
    EXPECT_TRUE(told > 0.4 && told < 2.5) << name << ": " << e.confinement_steps << " of " << record.confined.steps;
  }
}

TEST_F(Estimates, AContainerThatIsFilledToItsHeight) {
  const Set set{"layers.region=container", "container.size=[0.4,0.4,0.3]"};
  const report::Estimate e = of(without_probe({}), set);
  const report::RunRecord record = run::make_pack(comm_, scene(set), options(set));
  EXPECT_GE(record.particles, e.particles.least);
  EXPECT_LE(record.particles, e.particles.most);
  EXPECT_NEAR(static_cast<double>(std::ssize(record.layers)), static_cast<double>(e.layers.value), 1.0);
  EXPECT_LT(e.particles.value, of(without_probe({}), {"container.size=[0.4,0.4,0.3]"}).particles.value);
  const report::Estimate higher = of(without_probe({.particles = 2000}), set);
  EXPECT_NEAR(static_cast<double>(higher.particles.value), 2000.0, 2.0);
  EXPECT_EQ(higher.layer_thickness, 0.1);
  const report::Estimate wider = of(without_probe({.particles = 2000, .height = 0.3}), set);
  EXPECT_NEAR(static_cast<double>(wider.particles.value), 2000.0, 2.0);
}

// Of vessels that are neither box nor cylinder the height is found, for as many particles as they hold.
TEST_F(Estimates, OtherVesselsGetTheirHeight) {
  const std::string rest =
      "[particles]\ndensity = 1000\nyoungs_modulus = 1e7\npoisson_ratio = 0.25\n"
      "radius = { distribution = \"equal\", value = 0.005 }\n[layers]\nthickness = 0.05\nfraction = 0.25\n"
      "[jamming]\ngravity = 9.81\n[contact]\nfriction = 0.3\n";
  const auto found = [&](const std::string& shape, std::int64_t particles) {
    const input::Input in = input::parse("[container]\n" + shape + "height = 0.1\n" + rest, "vessel.toml", {});
    return forecast::estimate(comm_, in, without_probe({.particles = particles}));
  };
  const std::string frustum = "shape = \"frustum\"\nbottom_diameter = ";
  for (const std::string& shape :
       {frustum + "0.2\ntop_diameter = 0.1\n", std::string("shape = \"sphere\"\ndiameter = 0.2\n"),
        std::string("shape = \"annulus\"\ndiameter = 0.2\ninner_diameter = 0.08\n"),
        std::string("dimension = 2\nshape = \"circle\"\ndiameter = 0.6\n"),
        std::string("dimension = 2\nshape = \"trapezium\"\nbottom_width = 0.7\ntop_width = 0.5\n"),
        std::string("dimension = 2\nshape = \"polygon\"\npolygon = [[0.2, 0], [0.8, 0.3], [0.8, 0.8], [0, 0.6]]\n")}) {
    SCOPED_TRACE(shape);
    const report::Estimate e = found(shape, 2000);
    EXPECT_NEAR(static_cast<double>(e.particles.value), 2000.0, 20.0);
    EXPECT_EQ(e.found, "height");
    EXPECT_THAT(report::to_table(e), HasSubstr("container.height = "));
  }
  // Wider above, layers are whole: so thick that they hold as many, a little denser or looser, too.
  const report::Estimate widening = found(frustum + "0.1\ntop_diameter = 0.2\n", 1000);
  EXPECT_NEAR(static_cast<double>(widening.particles.value), 1000.0, 20.0);
  EXPECT_LT(static_cast<double>(widening.particles.most - widening.particles.least), 40.0);
  EXPECT_THAT(report::to_table(widening), HasSubstr("layers.thickness = "));
  try {
    (void)found("shape = \"sphere\"\ndiameter = 0.2\n", 9000);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("do not fit into this vessel"));
  }
}

TEST_F(Estimates, TheFractionIsThatOfKnownPacks) {
  const auto fraction = [&](const Set& set) { return scene::expected_fraction(scene(set)).value; };
  const Set paper{"container.size=[1,1,0.5]", "container.boundary=[\"wall\",\"wall\"]"};
  Set without = paper;
  without.emplace_back("dynamics.rotation=false");
  // doc/reproduction.md, example 5.3: particles, height and so the bed's fraction.
  const double volume = 4.0 / 3.0 * 3.141592653589793 * 8e-6;
  EXPECT_NEAR(fraction(paper), 9711 * volume / 0.5400, 0.004);
  EXPECT_NEAR(fraction(without), 8964 * volume / 0.5186, 0.004);
  EXPECT_EQ(of(without_probe({.fraction = 0.5})).fraction, 0.5);
  EXPECT_EQ(of(without_probe({.fraction = 0.5})).fraction_error, 0.0);
}

// 48,896 spheres under a lid, which came out at 0.063 radii, 0.0095 in the mean, with friction 0.5 by "balanced".
TEST(Overlaps, TheWorstOfManyIsTold) {
  const auto told = [](const std::string& modulus, const std::string& size) {
    return warnings_of(scene::build(input::parse(
        "[container]\nsize = " + size + "\nboundary = [\"periodic\", \"periodic\"]\n[particles]\ndensity = 2600\n" +
            "youngs_modulus = \"" + modulus + "\"\npoisson_ratio = 0.25\n" +
            "radius = { distribution = \"equal\", value = \"5 mm\" }\n[layers]\nthickness = 0.04\nfraction = 0.25\n" +
            "[jamming]\ngravity = 9.81\n[contact]\nfriction = 0.6\ntangential = \"mindlin\"\n" +
            "[confinement]\nvertical = \"50 kPa\"\n",
        "many.toml", {})));
  };
  EXPECT_THAT(told("260 MPa", "[0.8, 0.8, 0.06]"),
              ::testing::ElementsAre(AllOf(HasSubstr("the worst of about 1e+05 contacts may overlap by 0.061 "),
                                           HasSubstr("rest.worst_overlap = 0.05"), HasSubstr("3.8e+08 Pa or more"))));
  EXPECT_THAT(told("380 MPa", "[0.8, 0.8, 0.06]"), ::testing::IsEmpty());
  EXPECT_THAT(told("260 MPa", "[0.07, 0.07, 0.06]"), ::testing::IsEmpty()) << "of few contacts the worst is less";
}

// A soil of equal masses in equal ratios of size: of diameters there are as many as d^-4 says.
TEST(Fines, AreToldByNumberAndMayBeLeftOut) {
  const double finest = 0.075e-3, coarsest = 12.5e-3;
  std::string text = brick;
  text.replace(text.find("radius = "), std::string("radius = { distribution = \"equal\", value = 0.02 }").size(),
               "diameter = { distribution = \"grading\", weighting = \"mass\", diameter_curve = [[\"0.075 mm\", 0], "
               "[\"12.5 mm\", 100]] }");
  const scene::Scene soil = scene::build(input::parse(text, "soil.toml", {}));
  const auto found = scene::fines(soil);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->diameter, finest * std::pow(coarsest / finest, 0.05), 1e-6 * finest);
  const double all = std::pow(finest, -3.0) - std::pow(coarsest, -3.0);
  EXPECT_NEAR(found->share, (std::pow(finest, -3.0) - std::pow(found->diameter, -3.0)) / all, 1e-3);
  const double mean_volume = std::numbers::pi / 6.0 * 3.0 * std::log(coarsest / finest) / all;
  const double solid = scene::expected_fraction(soil).value * soil.container.mean_area() *
                       scene::expected_filling(soil, scene::expected_fraction(soil).value).height;
  EXPECT_NEAR(found->particles * mean_volume / solid, 1.0, 0.01);
  EXPECT_NEAR(found->without, found->particles * (1.0 - found->share) / 0.95, 1e-6 * found->particles);
  EXPECT_THAT(warnings_of(soil), ::testing::Contains(HasSubstr("keep_percent = [5, 100] leaves them out")));
  const auto part = [&](double of) { return scene::fines(soil, of)->without; };
  double least = 0.05;
  while (part(least) > 1e6) least += 0.05;
  ASSERT_GT(part(0.05), 1e6);
  EXPECT_THAT(warnings_of(soil),
              ::testing::Contains(HasSubstr(
                  fmt::format("; keep_percent = [{:g}, 100] leaves about {:.2g} in all", 100.0 * least, part(least)))));
  EXPECT_FALSE(scene::fines(scene::build(input::parse(brick, "brick.toml", {}))));
  text +=
      "[mixture]\nshare_by = \"mass\"\n[[component]]\nname = \"soil\"\nshare = 1\n[[component]]\nname = "
      "\"stones\"\nshare = 1\n"
      "radius = { distribution = \"equal\", value = 0.006 }\n";
  const scene::Scene both = scene::build(input::parse(text, "both.toml", {}));
  EXPECT_NEAR(scene::fines(both)->diameter, finest * std::pow(coarsest / finest, 0.1), 1e-3 * finest)
      << "of half the mass";
  EXPECT_THAT(warnings_of(both),
              ::testing::Contains(HasSubstr("keep_percent = [5, 100] of the component that has them")));
}

TEST_F(Estimates, RanksShareTheMemory) {
  const Set large{"container.size=[10,4,1]"};
  const report::Estimate one = of(without_probe({.ranks = 1}), large);
  const report::Estimate ten = of(without_probe({.ranks = 10}), large);
  EXPECT_EQ(one.ghosts, 0.0);
  EXPECT_NEAR(ten.ghosts, 2.0 * scene(large).list_range() / 1.0, 1e-12) << "slabs a metre thick";
  const double base = 51e6;
  EXPECT_NEAR(
      (static_cast<double>(ten.settling_bytes) - base) * 10.0 / (static_cast<double>(one.settling_bytes) - base),
      1.0 + 0.80 * ten.ghosts, 0.1 * ten.ghosts);
  EXPECT_GT(ten.writing_bytes, ten.settling_bytes);
}

// On wide, almost empty ground columns are wider than particles; slabs are fewer than columns.
TEST_F(Estimates, ThePromisedRanksAreThoseThatAreLetIn) {
  for (const char* kind : {"slab", "pencil", "metis"}) {
    for (const char* size : {"[60,60,0.3]", "[0.6,0.9,0.3]"}) {
      const Set set{fmt::format("container.size={}", size), fmt::format("parallel.decomposition={}", kind),
                    "layers.fraction=0.02"};
      const scene::Scene made = scene(set);
      const auto most = static_cast<int>(of(without_probe({.ranks = 1}), set).most_ranks);
      EXPECT_NO_THROW(scene::check_ranks(made.columns(), made.in.parallel.decomposition, most)) << kind << size;
      EXPECT_THROW(scene::check_ranks(made.columns(), made.in.parallel.decomposition, most + 1), Error) << kind << size;
      EXPECT_THAT(refusal(without_probe({.ranks = most + 1}), set), HasSubstr(fmt::format("at most {} ranks", most)));
    }
  }
}

TEST_F(Estimates, WhatHasNoAnswerIsRefused) {
  EXPECT_THAT(refusal(without_probe({.particles = 1000, .height = 0.2, .sides = {0.2, 0.2}})),
              HasSubstr("nothing to find"));
  EXPECT_THAT(refusal(without_probe({.sides = {0.2, std::nullopt}})), HasSubstr("--particles"));
  EXPECT_THAT(refusal(without_probe({.particles = 9, .sides = {std::nullopt}})), HasSubstr("1 side given"));
  EXPECT_THAT(refusal(without_probe({.ranks = 100000})), HasSubstr("use at most"));
  EXPECT_THAT(refusal(without_probe({.particles = 3, .height = 5.0})), HasSubstr("less than one"));
  EXPECT_THAT(refusal(without_probe({.particles = 2})), HasSubstr("less than a layer"));
}

TEST_F(Estimates, TheProbeRunsAndTheJsonSaysIt) {
  Question question{.ranks = 2};
  const report::Estimate e = of(question, {"layers.duration=0.02"});
  ASSERT_TRUE(e.probe);
  EXPECT_GT(e.probe->particle_steps_per_second, 0.0);
  EXPECT_GT(e.probe->particles, 0);
  EXPECT_NEAR(e.seconds,
              static_cast<double>(e.particle_steps) / (2.0 * e.probe->particle_steps_per_second) +
                  static_cast<double>(e.particles.value) / (2.0 * e.probe->insertions_per_second),
              1e-9 * e.seconds);
  const auto json = nlohmann::json::parse(report::to_json(e));
  EXPECT_EQ(json["format"], "packmpi-estimate");
  EXPECT_EQ(json["particles"]["value"], e.particles.value);
  EXPECT_EQ(json["files"]["pack"], e.pack_bytes);
  EXPECT_EQ(json["wall_seconds"], e.seconds);
  EXPECT_THAT(report::to_table(e), HasSubstr("wall time"));
}

// Several components have limits, too; strata, which have several recipes, do not.
TEST_F(Estimates, LimitsOfSeveralComponents) {
  const auto component = [](const char* name, double density, double radius) {
    return fmt::format(
        "[[component]]\nname = \"{}\"\nshare = 1\ndensity = {}\nyoungs_modulus = 1e7\npoisson_ratio = 0.25\n"
        "radius = {{ distribution = \"equal\", value = {} }}\n",
        name, density, radius);
  };
  const std::string mixed = R"(
[container]
size = [0.12, 0.12, 0.08]
[layers]
thickness = 0.06
fraction = 0.2
duration = 0.12
[jamming]
gravity = 9.81
[contact]
tangential = "mindlin"
friction = 0.4
[dynamics]
relaxation = 0.01
[rest]
wait = 0
[mixture]
share_by = "mass"
)" + component("a", 1000.0, 0.01) +
                            component("b", 2000.0, 0.008);
  const fs::path path = fs::path(testing::TempDir()) / fmt::format("mixed_{}.toml", ::getppid());
  const auto of_text = [&](const std::string& text) {
    if (comm_.rank() == 0) std::ofstream(path) << text;
    comm_.barrier();
    return limits(comm_, path.string(), {});
  };
  const report::LimitsReport found = of_text(mixed);
  EXPECT_EQ(found.loosest.fractions.size(), found.seeds.size());
  EXPECT_GT(found.loosest.fractions.front(), 0.3);
  EXPECT_THAT(found.protocol, HasSubstr("components' own, in proportion to friction 0.4"));
  comm_.barrier();
  try {
    of_text(mixed + "[[stratum]]\nname = \"low\"\ntop = 0.04\nshares = { a = 1 }\n[[stratum]]\nname = \"high\"\n");
    FAIL() << "strata have no limits";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("strata have several"));
  }
}

}  // namespace
}  // namespace packmpi::forecast
