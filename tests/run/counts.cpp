// Numbers of particles, lists of sizes, insertion alone: exact, and the same on any number of ranks.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "geometry/container.hpp"
#include "input/read.hpp"
#include "pack/pack.hpp"
#include "run/make_pack.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::string box =
    "[container]\nsize = [0.3, 0.3, 0.3]\nboundary = [\"periodic\", \"periodic\"]\n"
    "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e8\npoisson_ratio = 0.25\n"
    "[dynamics]\ntime_step = 1.0e-4\n[checkpoint]\nevery = \"off\"\n";
const std::string layered =
    "[layers]\nthickness = 0.1\nfraction = 0.2\nduration = 0.005\n[jamming]\ngravity = 2.0\n[rest]\nwait = "
    "0\nunbalanced_force = 1e9\nkinetic_energy = 1e9\nsupport = 1e9\n";
const std::string alone = "[layers]\nduration = 0\n";
const std::string equal = "particles.radius={ distribution = \"equal\", value = 0.02 }";
const std::string gaussian =
    "particles.radius={ distribution = \"gaussian\", mean = 0.018, sd = 0.002, min = 0.014, max = 0.022, weighting = "
    "\"number\" }";

std::vector<double> radii(std::int64_t count) {
  std::vector<double> list;
  for (std::int64_t k = 0; k < count; ++k) list.push_back(1e-4 * static_cast<double>(140 + (k * 37) % 80));
  return list;
}

std::string list_of(std::int64_t count, const std::string& order) {
  std::string text;
  for (const double r : radii(count)) text += fmt::format("{}{}", text.empty() ? "" : ", ", r);
  return "particles.radius={ distribution = \"list\", order = \"" + order + "\", radii = [" + text + "] }";
}

class Counts : public ::testing::Test {
 protected:
  const comm::Comm comm_{MPI_COMM_WORLD};
  const fs::path folder_ = fs::path(testing::TempDir()) / ("packmpi_counts_" + std::to_string(::getppid()));

  void SetUp() override {
    if (comm_.rank() == 0) fs::remove_all(folder_);
    comm_.barrier();
  }
  [[nodiscard]] Options options(const std::string& name) const {
    Options o;
    o.folder = (folder_ / name).string();
    o.verbosity = log::Verbosity::quiet;
    o.force = true;
    return o;
  }
  static scene::Scene scene(const std::string& text, const std::vector<std::string>& set) {
    return scene::build(input::parse(text, "box.toml", {set}));
  }
  // On all ranks, and on the first alone: equal to the bit.
  report::RunRecord made(const std::string& text, const std::vector<std::string>& set) {
    const scene::Scene what = scene(text, set);
    report::RunRecord record = make_pack(comm_, what, options("together"));
    if (comm_.rank() == 0) {
      (void)make_pack(comm::Comm(MPI_COMM_SELF), what, options("alone"));
      const pack::PackRows mine = rows(), other = pack::read_pack((folder_ / "alone" / "box.hdf").string());
      EXPECT_EQ(mine.position, other.position);
      EXPECT_EQ(mine.radius, other.radius);
      EXPECT_EQ(mine.velocity, other.velocity);
    }
    comm_.barrier();
    return record;
  }
  [[nodiscard]] pack::PackRows rows() const { return pack::read_pack((folder_ / "together" / "box.hdf").string()); }
};

// Least distance between the surfaces of two particles of a periodic box.
double least_gap(const pack::PackRows& rows, double length) {
  double least = length;
  for (std::size_t i = 0; i < rows.id.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 a = rows.position[i], b = rows.position[j];
      const double x = geometry::shortest(a[0] - b[0], length), y = geometry::shortest(a[1] - b[1], length);
      const double z = a[2] - b[2];
      least = std::min(least, std::sqrt(x * x + y * y + z * z) - rows.radius[i] - rows.radius[j]);
    }
  }
  return least;
}

// Boxes, discs, cylinders, walls; equal, graded and listed sizes; layers and insertion alone.
TEST_F(Counts, AreExactInTwentyScenes) {
  for (const std::int64_t count : {1, 10, 57, 150}) {
    const std::string number = fmt::format("particles.count={}", count);
    const std::vector<std::pair<std::string, std::vector<std::string>>> scenes{
        {box + layered, {equal, number}},
        {box + layered, {list_of(count, "random"), number, "container.boundary=[\"wall\", \"wall\"]"}},
        {"[container]\nshape = \"cylinder\"\ndiameter = 0.3\nheight = 0.4\n" + box.substr(box.find("[particles]")) +
             layered,
         {gaussian, number}},
        {"[container]\ndimension = 2\nsize = [0.5, 0.8]\nboundary = [\"wall\"]\n" +
             box.substr(box.find("[particles]")) + layered,
         {gaussian, number}},
        {box + alone, {gaussian, number}}};
    for (const auto& [text, set] : scenes) {
      const report::RunRecord record = made(text, set);
      EXPECT_EQ(record.particles, count) << text;
      EXPECT_EQ(record.audit.found, count) << text;
      EXPECT_TRUE(record.reached);
      EXPECT_EQ(record.stop_reason, "count");
      EXPECT_EQ(record.target_particles, count);
      std::int64_t inserted = 0;
      for (const report::LayerRow& row : record.layers) inserted += row.inserted;
      EXPECT_EQ(inserted, count);
    }
  }
}

TEST_F(Counts, TooFewLayersMissTheNumber) {
  const report::RunRecord record = made(box + layered, {equal, "particles.count=200", "layers.maximum=2"});
  EXPECT_FALSE(record.reached);
  EXPECT_EQ(record.particles, 108) << "two layers of 54";
  ASSERT_FALSE(record.missed.empty());
  EXPECT_EQ(record.missed.front(),
            "particles.count: 108 of 200 particles are there after 2 layers, the most there are (layers.maximum)");
}

TEST_F(Counts, EachSizeOfAListIsUsedOnce) {
  const std::vector<double> list = radii(130);
  (void)made(box + layered, {list_of(130, "file")});
  EXPECT_EQ(rows().radius, list) << "in the order of the file, layer by layer";
  (void)made(box + layered, {list_of(130, "random")});
  std::vector<double> shuffled = rows().radius, sorted = list;
  EXPECT_NE(shuffled, list);
  std::ranges::sort(shuffled);
  std::ranges::sort(sorted);
  EXPECT_EQ(shuffled, sorted);
  (void)made(box + layered, {list_of(130, "random"), "seed=2"});
  EXPECT_NE(rows().radius, shuffled);
}

// 1085 given diameters in the order of their file, layer by layer, none left out and none twice.
TEST_F(Counts, AFileOf1085DiametersIsUsedUp) {
  const std::vector<double> list = radii(1085);
  std::string text = "diameter_mm\n";
  for (const double r : list) text += fmt::format("{}\n", 2e3 * r);
  const scene::Scene what = scene::build(
      input::parse(box + layered, "box.toml",
                   {{R"(particles.diameter={ distribution = "list", list_file = "d.csv", order = "file" })"}},
                   {.curve = input::CurveFile{"d.csv", text}}));
  const report::RunRecord record = make_pack(comm_, what, options("together"));
  EXPECT_EQ(record.particles, 1085);
  const std::vector<double> got = rows().radius;
  ASSERT_EQ(got.size(), list.size());
  for (std::size_t k = 0; k < list.size(); ++k) ASSERT_NEAR(got[k], list[k], 1e-15) << k;
}

TEST_F(Counts, AStoppedRunGoesOnToTheSameNumber) {
  const scene::Scene what = scene(box + layered, {gaussian, "particles.count=200"});
  const report::RunRecord whole = made(box + layered, {gaussian, "particles.count=200"});
  const pack::PackRows target = rows();
  Options halfway = options("together");
  halfway.max_steps = 80;
  EXPECT_THROW((void)make_pack(comm_, what, halfway), comm::AgreedError);
  Options on = options("together");
  on.force = false;
  on.restart = "auto";
  EXPECT_EQ(make_pack(comm_, what, on).particles, 200);
  EXPECT_EQ(rows().position, target.position);
  EXPECT_EQ(rows().radius, target.radius);
  EXPECT_EQ(whole.steps, 50 * std::ssize(whole.layers));
}

TEST_F(Counts, InsertionAloneMeetsItsFraction) {
  const report::RunRecord record = made(box + alone, {equal, "layers.fraction=0.25", "layers.gap=1 mm"});
  EXPECT_TRUE(record.targets_met) << ::testing::PrintToString(record.missed);
  EXPECT_EQ(record.stop_reason, "fraction");
  EXPECT_EQ(record.steps, 0);
  EXPECT_EQ(record.particles, 202) << "the least number with 0.25";
  EXPECT_NEAR(record.phi, 202 * 4.0 / 3.0 * std::numbers::pi * 8e-6 / 0.027, 1e-12);
  EXPECT_GE(least_gap(rows(), 0.3), 1e-3 - 1e-12);
  EXPECT_LT(least_gap(rows(), 0.3), 1.5e-3);
}

// Fuller's curve, 2 to 16 mm: percent passing by mass 100 sqrt(d / 16 mm), what is finer than 2 mm left out.
const std::string fuller =
    "particles.diameter={ distribution = \"grading\", weighting = \"mass\", interpolation = \"log\", keep_percent = "
    "[35.36, "
    "100], diameter_curve = [[\"2 mm\", 35.36], [\"2.8 mm\", 41.83], [\"4 mm\", 50], [\"5.6 mm\", 59.16], [\"8 mm\", "
    "70.71], [\"11.2 mm\", 83.67], [\"16 mm\", 100]] }";

TEST_F(Counts, InsertionAloneOfAFullerCurve) {
  const std::vector<std::string> set{fuller, "container.size=[0.06, 0.06, 0.06]", "layers.fraction=0.45",
                                     "particles.density=2650"};
  const report::RunRecord record = made(box + alone, set);
  EXPECT_TRUE(record.targets_met);
  EXPECT_GE(record.phi, 0.45);
  EXPECT_LT(record.phi, 0.4501);
  EXPECT_GE(least_gap(rows(), 0.06), 0.0);
}

TEST_F(Counts, BeyondReachInsertionSaysHowFarItCame) {
  try {
    (void)make_pack(comm_, scene(box + alone, {equal, "layers.fraction=0.38", "layers.attempts=500"}),
                    options("together"));
    FAIL() << "equal spheres at 0.38 within 500 attempts";
  } catch (const comm::AgreedError& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_THAT(error.what(), HasSubstr("of 307 particles: solid fraction 0.3"));
    EXPECT_THAT(error.what(), HasSubstr("Lower layers.fraction (it saturates"));
    EXPECT_THAT(error.what(), HasSubstr("or raise container.size"));
  }
}

}  // namespace
}  // namespace packmpi::run
