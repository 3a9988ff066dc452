// CSV and LAMMPS data files: what is read, and what is refused with file and line: the first line of each file of bad/
// says how.
#include "start/text_rows.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "base/error.hpp"

namespace packmpi::start {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;

class TextRowsOf : public ::testing::Test {
 protected:
  [[nodiscard]] std::string file(const std::string& text) const {
    const fs::path path = fs::path(testing::TempDir()) / ("packmpi_text_rows_" + std::to_string(::getpid()));
    std::ofstream(path, std::ios::binary) << text;
    return path.string();
  }
  [[nodiscard]] TextRows csv(const std::string& text, int dimension = 3) const {
    return read_csv(file(text), dimension, 0, 1);
  }
  [[nodiscard]] TextRows lammps(const std::string& text) const { return read_lammps(file(text), 3, 0, 1); }
};

TEST_F(TextRowsOf, CsvWithoutNamesIsPositionAndRadius) {
  const TextRows found = csv("# a comment\n0.1,0.2,0.3,0.01\n\n-0.4, 5e-1 ,0.6,0.02\n");
  EXPECT_THAT(found.rows.id, ElementsAre(0, 1));
  EXPECT_THAT(found.rows.position, ElementsAre(Vec3{0.1, 0.2, 0.3}, Vec3{-0.4, 0.5, 0.6}));
  EXPECT_THAT(found.rows.radius, ElementsAre(0.01, 0.02));
  EXPECT_THAT(found.line, ElementsAre(2, 4));
  EXPECT_EQ(found.taken, "positions, radii");
  EXPECT_EQ(found.left, "");
}

TEST_F(TextRowsOf, CsvHasNamesInAnyOrderUnitsAndSpreadsheetsHabits) {
  const TextRows found =
      csv("\xEF\xBB\xBF"
          "Diameter [mm];z_mm;y (mm);X_mm;colour\r\n20;300,0;200;100,5;7\r\n");
  EXPECT_THAT(found.rows.radius, ElementsAre(0.01));
  EXPECT_THAT(found.rows.position, ElementsAre(Vec3{0.1005, 0.2, 0.3}));
  EXPECT_EQ(found.left, "1 other column");
}

TEST_F(TextRowsOf, CsvMayHaveBlanksAndVelocities) {
  const TextRows found = csv("x y z r vx vy vz wx\n1 2 3 0.5 4 5 6 7\n");
  EXPECT_THAT(found.rows.velocity, ElementsAre(Vec3{4, 5, 6}));
  EXPECT_THAT(found.rows.spin, ElementsAre(Vec3{}));
  EXPECT_EQ(found.taken, "positions, radii, velocities");
  EXPECT_EQ(found.left, "1 other column");
}

TEST_F(TextRowsOf, CsvHasUnitsOfVelocitiesToo) {
  const TextRows found = csv("x,y,z,r,vx [mm/s],vy_cm/s,vz (m/s),wx [rad/s],wy,wz\n1,2,3,0.5,4,5,6,7,8,9\n");
  EXPECT_THAT(found.rows.velocity, ElementsAre(Vec3{0.004, 0.05, 6}));
  EXPECT_THAT(found.rows.spin, ElementsAre(Vec3{7, 8, 9}));
}

TEST_F(TextRowsOf, CsvOfThePlaneNeedsNoZ) {
  EXPECT_THAT(csv("0.1,0.2,0.01\n", 2).rows.position, ElementsAre(Vec3{0.1, 0.2, 0.0}));
  EXPECT_THAT(csv("x,y,r\n0.1,0.2,0.01\n", 2).rows.radius, ElementsAre(0.01));
}

TEST_F(TextRowsOf, LammpsHasItsOwnIdsAndVelocitiesByThem) {
  const TextRows found = lammps(
      "a title\n\n2 atoms\n3 atom types\n\n-1 1 xlo xhi\n0 2 ylo yhi\n0 5 zlo zhi\n\nMasses\n\n1 1\n\nAtoms # "
      "sphere\n\n"
      "9 1 0.2 2500 0.1 0.2 0.3 0 0 0\n4 3 0.4 2500 0.5 0.6 0.7 0 0 1\n\nVelocities\n\n4 1 2 3 4 5 6\n9 0 0 1 0 0 2\n");
  EXPECT_THAT(found.rows.id, ElementsAre(0, 1));
  EXPECT_THAT(found.rows.radius, ElementsAre(0.1, 0.2));
  EXPECT_THAT(found.rows.position, ElementsAre(Vec3{0.1, 0.2, 0.3}, Vec3{0.5, 0.6, 0.7}));
  EXPECT_THAT(found.rows.velocity, ElementsAre(Vec3{0, 0, 1}, Vec3{1, 2, 3}));
  EXPECT_THAT(found.rows.spin, ElementsAre(Vec3{0, 0, 2}, Vec3{4, 5, 6}));
  ASSERT_TRUE(found.box);
  EXPECT_EQ((*found.box)[0][0], -1.0);
  EXPECT_EQ((*found.box)[2][1], 5.0);
  EXPECT_EQ(found.left, "atom ids, types, densities");
}

TEST_F(TextRowsOf, RanksShareTheRows) {
  std::string text = "x,y,z,r\n";
  for (int k = 0; k < 10; ++k) text += std::to_string(k) + ",0,0,1\n";
  const std::string path = file(text);
  std::vector<GlobalId> all;
  for (Rank rank = 0; rank < 3; ++rank) {
    const TextRows found = read_csv(path, 3, rank, 3);
    EXPECT_EQ(found.total, 10);
    for (std::size_t k = 0; k < found.rows.id.size(); ++k)
      EXPECT_EQ(found.rows.position[k][0], static_cast<double>(found.rows.id[k]));
    all.insert(all.end(), found.rows.id.begin(), found.rows.id.end());
  }
  std::ranges::sort(all);
  EXPECT_THAT(all, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9));
}

TEST_F(TextRowsOf, KindsAreKnownByTheirFirstBytes) {
  EXPECT_EQ(kind_of(file("x,y,z,r\n1,1,1,1\n")), Kind::csv);
  EXPECT_EQ(kind_of(file("title\n\n12 atoms\n")), Kind::lammps);
  EXPECT_EQ(kind_of(file("\x89HDF\r\n\x1A\n...")), Kind::pack);
}

TEST_F(TextRowsOf, DigestIsThatOfTheBytes) {
  const std::uint64_t one = digest_of_text(file("1,1,1,1\n"));
  EXPECT_NE(digest_of_text(file("1,1,1,2\n")), one);
  EXPECT_EQ(digest_of_text(file("1,1,1,1\n")), one);
}

TEST_F(TextRowsOf, LinesMayBeLongerThanABlockOfTheFile) {
  std::string text = "x,y,z,r\n";
  while (text.size() < (std::size_t{5} << 19)) text += "0.125,0.25,0.5,0.0625\n";
  const TextRows found = csv(text);
  EXPECT_EQ(found.total, static_cast<std::int64_t>((text.size() - 8) / 22));
  for (const Vec3& x : found.rows.position) ASSERT_EQ(x, (Vec3{0.125, 0.25, 0.5}));
}

TEST(BadTextRows, AreRefusedWithFileAndLine) {
  int files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(PACKMPI_SOURCE_DIR) / "tests/start/bad")) {
    const std::string path = entry.path().string();
    std::ifstream file(path, std::ios::binary);
    std::string first;
    std::getline(file, first);
    const std::string mark = "# expect: FILE";
    ASSERT_TRUE(first.starts_with(mark)) << path;
    try {
      if (entry.path().extension() == ".csv")
        (void)read_csv(path, 3, 0, 1);
      else
        (void)read_lammps(path, 3, 0, 1);
      ADD_FAILURE() << path << " was read";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input);
      EXPECT_EQ(error.what(), path + first.substr(mark.size()));
    }
    ++files;
  }
  EXPECT_EQ(files, 20);
}

TEST(BadTextRows, SayThatThereIsNoFile) { EXPECT_THROW((void)kind_of("/nowhere/rows.csv"), Error); }

}  // namespace
}  // namespace packmpi::start
