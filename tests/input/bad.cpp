// Wrong scenes, sieve tables and lists of sizes: each file of bad/ says in its first line what the reader must say,
// word for word, scenes on every rank.
#include <gtest/gtest.h>
#include <mpi.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "comm/comm.hpp"
#include "input/read.hpp"
#include "tables/sieve_table.hpp"

namespace packmpi::input {
namespace {

namespace fs = std::filesystem;

const fs::path bad_folder = fs::path(PACKMPI_SOURCE_DIR) / "tests/input/bad";

std::vector<std::string> bad_files(const std::string& ending = ".toml") {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(bad_folder)) {
    if (entry.path().extension() == ending) names.push_back(entry.path().filename().string());
  }
  std::ranges::sort(names);
  return names;
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The words promised in the first line, for a reader told that the file is called `name`.
std::string promised(const std::string& text, const std::string& name) {
  const std::string mark = "# expect: FILE";
  EXPECT_TRUE(text.starts_with(mark)) << name;
  return name + text.substr(mark.size(), text.find('\n') - mark.size());
}

/// What the action complains of; "" if it does not.
template <class Action>
std::string complaint(Action&& action) {
  try {
    action();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    return error.what();
  }
  return "";
}

const std::string good =
    "[container]\nsize = [1.0, 1.0, 0.5]\n"
    "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e8\npoisson_ratio = 0.25\n"
    "radius = { distribution = \"equal\", value = 0.02 }\n"
    "[layers]\nthickness = 0.1\nfraction = 0.25\n[jamming]\ngravity = 2.0\n";

std::string complaint_of_set(const std::vector<std::string>& set) {
  return complaint([&] { (void)parse(good, "good.toml", {set}); });
}

class Bad : public ::testing::TestWithParam<std::string> {};

TEST_P(Bad, ParseSaysExactlyThis) {
  const std::string text = text_of(bad_folder / GetParam());
  EXPECT_EQ(complaint([&] { (void)parse(text, GetParam(), {}); }), promised(text, GetParam()));
}

TEST_P(Bad, ReadSaysTheSameOnEveryRank) {
  const comm::Comm world(MPI_COMM_WORLD);
  const fs::path path = bad_folder / GetParam();
  EXPECT_EQ(complaint([&] { (void)read(world, path.string(), {}); }), promised(text_of(path), path.string()));
}

std::string stem(const ::testing::TestParamInfo<std::string>& file) { return fs::path(file.param).stem().string(); }

INSTANTIATE_TEST_SUITE_P(Files, Bad, ::testing::ValuesIn(bad_files()), stem);

class BadTable : public ::testing::TestWithParam<std::string> {};

TEST_P(BadTable, ReaderSaysExactlyThis) {
  const CurveFile file{GetParam(), text_of(bad_folder / GetParam())};
  const bool sieves = GetParam().starts_with("sieves_");
  ASSERT_TRUE(sieves || GetParam().starts_with("sizes_"));
  EXPECT_EQ(complaint([&] { sieves ? (void)tables::read_sieve_table(file) : (void)tables::read_size_list(file); }),
            promised(file.text, file.path));
}

INSTANTIATE_TEST_SUITE_P(Files, BadTable, ::testing::ValuesIn(bad_files(".csv")), stem);

TEST(BadInput, TheGoodSceneOfTheseTestsIsGood) { EXPECT_EQ(complaint_of_set({}), ""); }

TEST(BadInput, EveryComplaintIsOneLine) {
  for (const std::string& name : bad_files()) {
    const std::string words = complaint([&] { (void)parse(text_of(bad_folder / name), name, {}); });
    EXPECT_TRUE(std::ranges::none_of(words, [](unsigned char c) { return c < 0x20; })) << name;
  }
}

TEST(BadInput, EmptyFile) {
  EXPECT_EQ(complaint([] { (void)parse("", "a.toml", {}); }),
            "a.toml:1: the file is empty; see doc/input.md for a first scene");
}

TEST(BadInput, HugeFile) {
  EXPECT_EQ(complaint([] { (void)parse(std::string((4U << 20U) + 1, '\n'), "a.toml", {}); }),
            "a.toml:1: the file is longer than 4 MiB; is it a scene?");
}

TEST(BadInput, NestingThatWouldOverflowTheStack) {
  std::string lists = "x = ", tables = "x = [\n", key;
  for (int i = 0; i < 100'000; ++i) lists += '[';
  for (int i = 0; i < 1000; ++i) key += "b . ";
  for (int i = 0; i < 200; ++i) tables += "{" + key + "b = [\n";
  EXPECT_TRUE(complaint([&] { (void)parse(lists, "a.toml", {}); }).starts_with("a.toml:1: not TOML: "));
  EXPECT_EQ(complaint([&] { (void)parse(tables, "a.toml", {}); }),
            "a.toml:2: a key of too many parts; no key has more than three");
}

// toml++ 3.3 tells the compiler that U+00A1 to U+0499 cannot come where it looks for blanks. No compiler may make
// blanks of them: they would be passed over.
TEST(BadInput, LettersThatAreNoBlanks) {
  for (unsigned code = 0xa1; code < 0x49a; ++code) {
    const std::string letter{static_cast<char>(0xc0U | code >> 6U), static_cast<char>(0x80U | (code & 0x3fU))};
    EXPECT_NE(complaint_of_set({"layers.fraction=0.25 " + letter}), "") << code;
    EXPECT_NE(complaint([&] { (void)parse("seed = 1 " + letter + "\n" + good, "a.toml", {}); }), "") << code;
    EXPECT_EQ(complaint([&] { (void)parse("# " + letter + "\n" + good, "a.toml", {}); }), "") << code;
  }
}

TEST(BadInput, FolderAndMissingFile) {
  const comm::Comm world(MPI_COMM_WORLD);
  const std::string folder = bad_folder.string(), nowhere = (bad_folder / "no_such_file.toml").string();
  EXPECT_EQ(complaint([&] { (void)read(world, folder, {}); }), folder + ": is a folder; give a scene file (.toml)");
  EXPECT_EQ(complaint([&] { (void)read(world, nowhere, {}); }),
            nowhere + ": cannot be opened (No such file or directory); check the path");
}

TEST(BadInput, TablesThatNoCommentCanStandIn) {
  const auto sieves = [](const std::string& text) {
    return complaint([&] { (void)tables::read_sieve_table({"g.csv", text}); });
  };
  EXPECT_EQ(sieves(""), "g.csv:1: is empty; the first line must be \"diameter_mm,percent_passing\"");
  EXPECT_EQ(sieves("\xff\xfe"), "g.csv:1: is UTF-16; save it as CSV in UTF-8");
  EXPECT_EQ(complaint([&] {
              (void)tables::read_size_list({"g.csv", ""});
            }),
            "g.csv:1: is empty; the first line must be \"diameter_mm\" or \"radius_mm\"");
}

TEST(BadInput, FinesOfWhichNothingIsKnown) {
  const std::string scene =
      "particles.radius={ distribution = \"grading\", weighting = \"mass\", diameter_curve_file = \"g.csv\" }";
  const CurveFile file{"g.csv", "sieve_mm,mass_retained_g\n40,0\n20,150\n10,40\npan,10\n"};
  EXPECT_EQ(
      complaint([&] { (void)parse(good, "good.toml", {{scene}}, {.curve = file}); }),
      "g.csv: the curve begins at 5 percent; begin with the diameter that nothing passes, 0 percent, or leave the "
      "finest out: keep_percent = [5, 100]");
}

// 3 of 103 g: 2.9126... percent, which two places must not fall short of.
TEST(BadInput, TheShareOfFinesThatIsProposedIsTaken) {
  const CurveFile file{"g.csv", "sieve_mm,mass_retained_g\n95,0\n47,40\n23,60\npan,3\n"};
  const auto parsed = [&](const std::string& more) {
    (void)parse(good, "good.toml",
                {{"particles.radius={ distribution = \"grading\", weighting = \"mass\", diameter_curve_file = "
                  "\"g.csv\"" +
                  more + " }"}},
                {.curve = file});
  };
  const std::string said = complaint([&] { parsed(""); });
  EXPECT_NE(said.find("begins at 2.91262 percent"), std::string::npos) << said;
  EXPECT_NE(said.find("keep_percent = [2.92, 100]"), std::string::npos) << said;
  EXPECT_NO_THROW(parsed(", keep_percent = [2.92, 100]"));
}

TEST(BadInput, AGradingFileLiesBesideTheScene) {
  for (const std::string name : {"/etc/passwd", "../a.csv", "a/../../b.csv", ".."}) {
    const std::string set =
        "particles.radius={ distribution = \"grading\", weighting = \"mass\", diameter_curve_file = \"" + name + "\" }";
    EXPECT_EQ(complaint([&] { (void)named_files("[particles]\n", "x/a.toml", {{set}}); }),
              "--set " + set + ": particles.radius.diameter_curve_file: is \"" + name +
                  "\"; a curve lies in the scene's folder or below it: give a path from there, without \"..\"");
  }
}

TEST(BadInput, AGradingFileThatIsNotThere) {
  const comm::Comm world(MPI_COMM_WORLD);
  const std::string scene = (fs::path(PACKMPI_SOURCE_DIR) / "input/quickstart.toml").string();
  const std::string set =
      "particles.radius={ distribution = \"grading\", weighting = \"mass\", diameter_curve_file = \"no.csv\" }";
  EXPECT_EQ(complaint([&] { (void)read(world, scene, {{set}}); }),
            (fs::path(PACKMPI_SOURCE_DIR) / "input/no.csv").string() +
                ": cannot be opened (No such file or directory); check the path");
}

TEST(BadInput, Overrides) {
  EXPECT_EQ(complaint_of_set({"seed"}), "--set seed: not an assignment; write --set key.path=value");
  EXPECT_EQ(complaint_of_set({"=3"}), "--set =3: not an assignment; write --set key.path=value");
  EXPECT_EQ(complaint_of_set({"layers.=3"}), "--set layers.=3: not an assignment; write --set key.path=value");
  EXPECT_EQ(complaint_of_set({"layers.fracton=0.3"}),
            "--set layers.fracton=0.3: layers.fracton: unknown key; did you mean \"fraction\"?");
  EXPECT_EQ(complaint_of_set({"layers.fraction=3"}),
            "--set layers.fraction=3: layers.fraction: 3 is out of range; give a number > 0 and < 1");
  EXPECT_EQ(
      complaint_of_set({"layers.fraction=0.5"}),
      "--set layers.fraction=0.5: layers.fraction: 0.5 is beyond 0.384, where random insertion of equal spheres ends; "
      "lower it (0.25 is usual)");
  EXPECT_EQ(complaint_of_set({"seed.x=1"}), "--set seed.x=1: seed: is a table; give a whole number >= 0");
  EXPECT_EQ(complaint_of_set({"container.size=[1, 2"}),
            "--set container.size=[1, 2: the value is not TOML; check its quotes and brackets");
  EXPECT_EQ(complaint_of_set({"seed=1\nlayers=2"}),
            "--set \"seed=1\\u000alayers=2\": seed: is \"1\\u000alayers=2\"; give a whole number >= 0");
  EXPECT_EQ(complaint_of_set({"near_field.alpha1=1"}),
            "--set near_field.alpha1=1: near_field.cutoff: is missing; give a number > 0 [m]");
}

}  // namespace
}  // namespace packmpi::input
