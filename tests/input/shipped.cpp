// What we ship of input: the scenes of input/ and the page doc/input.md.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <tuple>
#include <vector>

#include "input/read.hpp"

namespace packmpi::input {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The scenes we ship must stay readable: with what a newcomer would change, too.
TEST(Scenes, AreAllGood) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(PACKMPI_SOURCE_DIR) / "input")) {
    if (entry.path().extension() != ".toml") continue;
    ++count;
    const std::string text = text_of(entry.path()), path = entry.path().string();
    const Input in = parse(text, path, {}, named_files(text, path, {}));
    EXPECT_EQ(parse(in.effective, "a.toml", {}).effective, in.effective) << entry.path();
  }
  EXPECT_GE(count, 8);
}

TEST(Scenes, ThePapersAreThePapers) {
  for (const auto& [name, dimension, r, sd, fraction] : {std::tuple{"5_1", 2, 0.01, 0.0, 0.4},
                                                         {"5_2", 2, 0.01, 0.001, 0.4},
                                                         {"5_3", 3, 0.02, 0.0, 0.25},
                                                         {"5_4", 3, 0.02, 0.002, 0.25}}) {
    const fs::path path = fs::path(PACKMPI_SOURCE_DIR) / "input" / (std::string("paper_") + name + ".toml");
    const Input in = parse(text_of(path), path.string(), {});
    EXPECT_EQ(in.container.size,
              dimension == 2 ? std::vector<double>({1.0, 0.5}) : std::vector<double>({1.0, 1.0, 0.5}));
    const Radius& radius = in.particles.radius;
    EXPECT_EQ(sd > 0.0 ? radius.mean : radius.value, r) << name;
    EXPECT_EQ(radius.sd, sd) << name;
    EXPECT_EQ(radius.min, sd > 0.0 ? r == 0.01 ? 0.007 : 0.014 : 0.0) << name;
    EXPECT_EQ(radius.max, sd > 0.0 ? r == 0.01 ? 0.013 : 0.026 : 0.0) << name;
    EXPECT_EQ(in.layers.fraction, fraction) << name;
    EXPECT_EQ(in.layers.thickness, 0.1) << name;
    EXPECT_EQ(in.layers.duration, 1.0) << name;
    EXPECT_EQ(in.particles.density, 1000.0) << name;
    EXPECT_EQ(in.particles.youngs_modulus, 1e8) << name;
    EXPECT_EQ(in.particles.poisson_ratio, 0.25) << name;
    EXPECT_EQ(in.contact.damping_ratio, 0.1) << name;
    EXPECT_EQ(in.contact.friction, 0.2) << name;
    EXPECT_EQ(in.contact.wall_friction, 0.2) << name;
    EXPECT_EQ(in.jamming.gravity, 2.0) << name;
    EXPECT_EQ(in.drag.coefficient, 0.005) << name;
    EXPECT_EQ(in.dynamics.time_step, 1e-4) << name;
    EXPECT_TRUE(in.dynamics.rotation) << name;
    EXPECT_FALSE(in.near_field.has_value()) << name;
  }
}

/// doc/input.md holds reference() between two markers. PACKMPI_UPDATE_DOC=1 in the environment writes it anew.
TEST(Documentation, KeyTablesAreNotStale) {
  const std::string begin = "<!-- generated from src/input/keys.cpp: begin -->\n", end = "<!-- generated: end -->";
  const fs::path path = fs::path(PACKMPI_SOURCE_DIR) / "doc/input.md";
  const std::string page = text_of(path);
  ASSERT_NE(page.find(begin), std::string::npos);
  ASSERT_NE(page.find(end), std::string::npos);
  const std::size_t from = page.find(begin) + begin.size();
  const std::string fresh = page.substr(0, from) + reference() + page.substr(page.find(end));
  if (std::getenv("PACKMPI_UPDATE_DOC") != nullptr) std::ofstream(path, std::ios::binary) << fresh;
  EXPECT_TRUE(text_of(path) == fresh)
      << "doc/input.md is older than the key table: run this test with PACKMPI_UPDATE_DOC=1 in the environment";
}

/// The documentation's first scene is a scene.
TEST(Documentation, ExampleReads) {
  const std::string page = text_of(fs::path(PACKMPI_SOURCE_DIR) / "doc/input.md");
  const std::size_t begin = page.find("```toml\n") + 8;
  const Input in = parse(page.substr(begin, page.find("```", begin) - begin), "input.md", {});
  EXPECT_EQ(in.container.size.size(), 3U);
}

}  // namespace
}  // namespace packmpi::input
