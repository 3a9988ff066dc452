// Packs in memory: against the file that the program writes, to the bit; who listens; errors; a part of the ranks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "comm/comm.hpp"
#include "pack/pack.hpp"
#include "packmpi/packmpi.hpp"

namespace packmpi {
namespace {

constexpr const char* text = R"(seed = 3
[container]
size = [0.2, 0.2, 0.05]
[particles]
density = 1000.0
youngs_modulus = 1.0e7
poisson_ratio = 0.25
radius = { distribution = "uniform", min = 0.012, max = 0.02, weighting = "number" }
[layers]
thickness = 0.06
fraction = 0.15
duration = 0.4
[jamming]
gravity = 5.0
[contact]
tangential = "mindlin"
[dynamics]
time_step = 1.0e-4
[rest]
wait = 0
[output]
contacts = true
)";

class Packings : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto mine = std::filesystem::temp_directory_path() / ("packmpi-packing-" + std::to_string(getpid()));
    folder_ = comm_.broadcast(0, mine.string());
    if (comm_.rank() == 0) std::filesystem::create_directories(folder_);
    comm_.barrier();
  }
  void TearDown() override {
    comm_.barrier();
    if (comm_.rank() == 0) std::filesystem::remove_all(folder_);
  }
  comm::Comm comm_{MPI_COMM_WORLD};
  std::string folder_;
  Scene scene_ = Scene::from_text(text);
};

std::vector<double> flat(const std::vector<Vec3>& rows) {
  std::vector<double> all;
  for (const Vec3& row : rows) all.insert(all.end(), row.begin(), row.end());
  return all;
}

// Against the file, on rank 0, where everything is.
void expect_as_in_file(const Packing& all, const std::string& path) {
  const pack::PackRows file = pack::read_pack(path);
  ASSERT_GT(file.id.size(), 20U);
  using ::testing::ElementsAreArray;
  EXPECT_THAT(all.id(), ElementsAreArray(file.id));
  EXPECT_THAT(all.position(), ElementsAreArray(flat(file.position)));
  EXPECT_THAT(all.velocity(), ElementsAreArray(flat(file.velocity)));
  EXPECT_THAT(all.spin(), ElementsAreArray(flat(file.spin)));
  EXPECT_THAT(all.radius(), ElementsAreArray(file.radius));
  EXPECT_THAT(all.layer(), ElementsAreArray(file.layer));
  EXPECT_THAT(all.contacts(), ElementsAreArray(file.contacts));
  EXPECT_THAT(all.component(), ElementsAreArray(file.component));
}

TEST_F(Packings, AreToTheBitWhatTheProgramWrites) {
  const Packing in_memory = make_packing(scene_, MPI_COMM_WORLD);
  EXPECT_FALSE(std::filesystem::exists(folder_ + "/scene.hdf"));
  EXPECT_TRUE(std::ranges::is_sorted(in_memory.id()));
  const Packing beside_files = make_packing(scene_, MPI_COMM_WORLD, {.folder = folder_});
  for (const Packing& pack : {in_memory, beside_files}) {
    const Packing all = pack.gathered(MPI_COMM_WORLD);
    EXPECT_EQ(comm_.sum(pack.count()), comm_.sum(all.count()));
    if (comm_.rank() == 0) {
      expect_as_in_file(all, folder_ + "/scene.hdf");
    } else {
      EXPECT_EQ(all.count(), 0);
    }
  }
  in_memory.write(MPI_COMM_WORLD, folder_ + "/share.hdf");
  const Packing all = in_memory.gathered(MPI_COMM_WORLD);
  all.write(MPI_COMM_WORLD, folder_ + "/all.hdf");
  EXPECT_THROW(all.write(MPI_COMM_WORLD, folder_ + "/all.hdf"), Failure);
  if (comm_.rank() != 0) return;
  expect_as_in_file(all, folder_ + "/share.hdf");
  expect_as_in_file(all, folder_ + "/all.hdf");
}

// What comes after the layers is not forgotten in memory.
TEST_F(Packings, AreUnderTheLidOfTheProgram) {
  const Scene pressed = Scene::from_text(text, "pressed.toml", {"confinement.vertical=500.0"});
  const Packing in_memory = make_packing(pressed, MPI_COMM_WORLD).gathered(MPI_COMM_WORLD);
  (void)make_packing(pressed, MPI_COMM_WORLD, {.folder = folder_});
  if (comm_.rank() == 0) expect_as_in_file(in_memory, folder_ + "/pressed.hdf");
}

// Of several components each particle has its own, in a share, gathered and in files.
TEST_F(Packings, HaveTheComponentsOfTheProgram) {
  const std::string two = std::string(text) +
                          "[mixture]\nshare_by = \"mass\"\n"
                          "[[component]]\nname = \"heavy\"\nshare = 1.0\ndensity = 3000.0\n"
                          "radius = { distribution = \"equal\", value = 0.012 }\n"
                          "[[component]]\nname = \"light\"\nshare = 2.0\n";
  const Scene scene = Scene::from_text(two, "two.toml", {});
  const Packing share = make_packing(scene, MPI_COMM_WORLD);
  const Packing all = share.gathered(MPI_COMM_WORLD);
  (void)make_packing(scene, MPI_COMM_WORLD, {.folder = folder_});
  share.write(MPI_COMM_WORLD, folder_ + "/share.hdf");
  all.write(MPI_COMM_WORLD, folder_ + "/all.hdf");
  EXPECT_EQ(std::ssize(share.component()), share.count());
  if (comm_.rank() != 0) return;
  for (const char* file : {"/two.hdf", "/share.hdf", "/all.hdf"}) expect_as_in_file(all, folder_ + file);
  EXPECT_GT(std::ranges::count(all.component(), 0), 3);
  EXPECT_GT(std::ranges::count(all.component(), 1), 3);
  for (std::size_t k = 0; k < all.component().size(); ++k) EXPECT_EQ(all.component()[k] == 0, all.radius()[k] == 0.012);
}

TEST_F(Packings, SpansStayWhereTheyAre) {
  const Packing pack = make_packing(scene_, MPI_COMM_WORLD);
  const Packing copy = pack;
  EXPECT_EQ(pack.position().data(), pack.position().data());
  EXPECT_EQ(copy.position().data(), pack.position().data());
  EXPECT_EQ(copy.pair_contacts().force.data(), pack.pair_contacts().force.data());
  EXPECT_EQ(std::ssize(pack.position()), 3 * pack.count());
}

// Newton's third law and the floor: contacts between particles and with walls, over all ranks, carry the weight.
TEST_F(Packings, ContactsCarryTheWeight) {
  const Packing all = make_packing(scene_, MPI_COMM_WORLD).gathered(MPI_COMM_WORLD);
  if (comm_.rank() != 0) return;
  const ContactSpans& pairs = all.pair_contacts();
  EXPECT_EQ(2 * pairs.overlap.size(), pairs.pair.size());
  EXPECT_EQ(pairs.displacement.size(), pairs.force.size());
  std::map<std::int64_t, int> touching;
  for (const std::int64_t id : pairs.pair) ++touching[id];
  for (std::size_t k = 0; k < all.id().size(); ++k) EXPECT_EQ(touching[all.id()[k]], all.contacts()[k]);
  const ContactSpans& walls = all.wall_contacts();
  double support = 0.0, weight = 0.0;
  for (std::size_t k = 0; k < walls.wall.size(); ++k) support += walls.force[3 * k + 2];
  for (const double r : all.radius()) weight += 1000.0 * 5.0 * 4.0 / 3.0 * 3.14159265358979 * r * r * r;
  EXPECT_NEAR(support / weight, 1.0, 0.2);
}

TEST_F(Packings, TellHowFarTheyAre) {
  std::vector<Progress> told;
  const Packing pack =
      make_packing(scene_, MPI_COMM_WORLD, {.progress = [&](const Progress& now) { told.push_back(now); }});
  ASSERT_GT(told.size(), 2U);
  EXPECT_STREQ(told.front().stage, "inserting");
  EXPECT_EQ(told.front().layer, 1);
  EXPECT_EQ(told.back().share, 1.0);
  EXPECT_EQ(comm_.sum(pack.count()), told.back().particles);
}

TEST_F(Packings, WhoListensMayEndThem) {
  struct Enough {};
  const bool mine = comm_.rank() == comm_.size() - 1;
  RunOptions options;
  if (mine)
    options.progress = [](const Progress& now) {
      if (now.share > 0.5) throw Enough{};
    };
  if (mine) {
    EXPECT_THROW((void)make_packing(scene_, MPI_COMM_WORLD, options), Enough);
  } else {
    try {
      (void)make_packing(scene_, MPI_COMM_WORLD, options);
      FAIL();
    } catch (const Failure& failure) {
      EXPECT_EQ(failure.code(), 75);
    }
  }
}

TEST_F(Packings, APartOfTheRanksMayMakeOne) {
  const bool in = comm_.rank() == 0;
  const comm::Comm part = comm_.split(in ? 0 : 1);
  std::int64_t alone = 0;
  if (in) alone = make_packing(scene_, part.handle()).count();
  const std::int64_t all = comm_.sum(make_packing(scene_, MPI_COMM_WORLD).count());
  EXPECT_EQ(in ? alone : all, all);
}

// What is wrong, where, of which key; on all ranks.
TEST_F(Packings, ErrorsSayWhere) {
  const auto failure_of = [](const std::function<void()>& action) {
    try {
      action();
    } catch (const Failure& failure) {
      return failure;
    }
    return Failure(0, "none");
  };
  const Failure unknown = failure_of([] { (void)Scene::from_text("[container]\nsiez = [1, 1, 1]\n", "a.toml"); });
  EXPECT_EQ(unknown.code(), 2);
  EXPECT_EQ(unknown.file(), "a.toml");
  EXPECT_EQ(unknown.line(), 2);
  EXPECT_EQ(unknown.key(), "container.siez");
  const Failure set = failure_of([] { (void)Scene::from_text(text, "a.toml", {"layers.fraction=0.9"}); });
  EXPECT_EQ(set.key(), "layers.fraction") << set.what();
  const Failure syntax = failure_of([] { (void)Scene::from_text("a = = 1", "a.toml"); });
  EXPECT_EQ(syntax.line(), 1) << syntax.what();
  EXPECT_EQ(syntax.key(), "");
  const Failure missing = failure_of([] { (void)Scene::from_file("none.toml"); });
  EXPECT_EQ(missing.code(), 2);
  const Failure several =
      failure_of([] { (void)make_packing(Scene::from_text(text, "a.toml", {"ensemble.packs=3"}), MPI_COMM_WORLD); });
  EXPECT_EQ(several.code(), 2);
  EXPECT_EQ(several.key(), "ensemble") << several.what();
  EXPECT_EQ(failure_of([&] { (void)analyze(MPI_COMM_WORLD, folder_ + "/none.hdf"); }).code(), 5);
  EXPECT_EQ(failure_of([&] { (void)convert(MPI_COMM_WORLD, "none.hdf", "no_format"); }).code(), 2);
}

TEST_F(Packings, ASpecimenIsCutOutOfAPackFile) {
  make_packing(scene_, MPI_COMM_WORLD).write(MPI_COMM_WORLD, folder_ + "/whole.hdf", true);
  const auto converted = [&](const std::string& cut) {
    return convert(MPI_COMM_WORLD, folder_ + "/whole.hdf", "csv",
                   {.file = folder_ + "/part.csv", .cut = cut, .force = true});
  };
  const Converted whole = converted(""), part = converted("box:length=0.16,width=0.16,height=0.05");
  EXPECT_EQ(whole.cut, "");
  EXPECT_GT(part.particles, 0);
  EXPECT_LT(part.particles, whole.particles / 2);
  EXPECT_LT(part.volume, part.cut_fraction * 0.16 * 0.16 * 0.05) << "spheres that the sides cut are not kept";
  EXPECT_EQ(part.files, std::vector<std::string>{folder_ + "/part.csv"});
  EXPECT_THROW((void)converted("tube:length=1"), Failure);
}

TEST_F(Packings, TellsWhatAFewLinesCost) {
  const std::string facts = check(scene_, MPI_COMM_WORLD);
  EXPECT_NE(facts.find("\"most_ranks\""), std::string::npos) << facts;
  const std::string told = estimate(scene_, MPI_COMM_WORLD, {.particles = 200, .ranks = 2, .probe = false});
  EXPECT_NE(told.find("\"particle_steps\""), std::string::npos) << told;
}

TEST_F(Packings, WhatOverridesAPresetIsTold) {
  const auto remarks = [&](const std::vector<std::string>& changes) {
    return nlohmann::json::parse(check(Scene::from_text(text, "a.toml", changes), MPI_COMM_WORLD))["remarks"];
  };
  EXPECT_TRUE(remarks({}).empty());  // no preset
  const std::vector<std::string> as_it_is{"fidelity=balanced", "dynamics.time_step=auto", "layers.duration=0.18"};
  const auto told = remarks(as_it_is);  // about 1.2 times the fall through 0.06 m at 5 m/s2, 0.186 s
  ASSERT_EQ(told.size(), 1U) << told;
  EXPECT_THAT(told[0].get<std::string>(),
              ::testing::StartsWith("fidelity = \"balanced\" is not all of it, the scene has layers.duration = 0.18 "
                                    "(the preset: 0.186): about "));
  const auto dearer = remarks({"fidelity=balanced", "layers.duration=1.86"});
  ASSERT_EQ(dearer.size(), 1U) << dearer;
  const std::string words = dearer[0];
  EXPECT_NE(words.find("dynamics.time_step = 1e-04 (the preset: \"auto\")"), std::string::npos) << words;
  EXPECT_GT(std::stod(words.substr(words.rfind("about ") + 6)), 5.0) << words;  // ten times the duration of layers
}

}  // namespace
}  // namespace packmpi
