// Going on from CSV and LAMMPS data files: to the bit, on any number of ranks, and what does not fit.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numeric>

#include "input/read.hpp"
#include "pack/pack.hpp"
#include "run/make_pack.hpp"
#include "start/fit.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::string base =
    "fidelity = \"balanced\"\n[container]\nsize = [0.3, 0.3, 0.08]\nboundary = [\"periodic\", \"wall\"]\n"
    "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e7\npoisson_ratio = 0.25\n"
    "radius = { distribution = \"uniform\", min = 0.015, max = 0.02, weighting = \"number\" }\n"
    "[layers]\nthickness = 0.1\nfraction = 0.2\n[jamming]\ngravity = 9.81\n[contact]\nfriction = 0.4\n"
    "[checkpoint]\nevery = \"off\"\n";

class StartText : public ::testing::Test {
 protected:
  const comm::Comm comm_{MPI_COMM_WORLD};
  const fs::path folder_ = fs::path(testing::TempDir()) / ("packmpi_start_text_" + std::to_string(::getppid()));

  void SetUp() override {
    if (comm_.rank() == 0) fs::remove_all(folder_), fs::create_directories(folder_);
    comm_.barrier();
  }
  report::RunRecord make(const comm::Comm& comm, const std::string& name, const std::string& more,
                         const std::vector<std::string>& set) {
    Options o;
    o.folder = folder_.string();
    o.verbosity = log::Verbosity::quiet;
    o.force = true;
    const std::string path = (folder_ / (name + ".toml")).string();
    const report::RunRecord record =
        make_pack(comm, scene::build(start::with_start(comm, input::parse(base + more, path, {set}))), o);
    comm.barrier();
    return record;
  }
  report::RunRecord go_on(const std::string& file, std::vector<std::string> set, const std::string& more = "") {
    return make(comm_, "next", more + "[start]\npack = \"" + file + "\"\n", std::move(set));
  }
  void write(const std::string& file, const std::string& text) const {
    if (comm_.rank() == 0) std::ofstream(folder_ / file, std::ios::binary) << text;
    comm_.barrier();
  }
  [[nodiscard]] pack::PackRows rows(const std::string& name) const {
    return pack::read_pack((folder_ / (name + ".hdf")).string());
  }
  std::string complaint(const std::string& text, std::vector<std::string> set = {}, const std::string& more = "") {
    write("bad.csv", text);
    try {
      (void)go_on("bad.csv", std::move(set), more);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_input);
      return error.what();
    }
    return "";
  }
};

const std::string two_components =
    "[mixture]\nshare_by = \"mass\"\n[[component]]\nname = \"a\"\nshare = 1\n[[component]]\nname = \"b\"\nshare = 1\n";
const std::vector<std::string> nothing_moves{"dynamics.relaxation=0", "rest.wait=0"};

std::string csv_of(const pack::PackRows& all) {
  std::string text = "id,x,y,z,radius,vx,vy,vz,wx,wy,wz\n";
  for (std::size_t k = 0; k < all.id.size(); ++k) {
    const Vec3 &x = all.position[k], &v = all.velocity[k], &w = all.spin[k];
    text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n", all.id[k], x[0], x[1], x[2], all.radius[k], v[0], v[1],
                        v[2], w[0], w[1], w[2]);
  }
  return text;
}

// A box from -0.25 along x, atoms numbered backwards from 7 N on.
std::string lammps_of(const pack::PackRows& all) {
  const auto atom = [&](std::size_t k) { return 7 * (all.id.size() - k); };
  std::string atoms, velocities;
  for (std::size_t k = 0; k < all.id.size(); ++k) {
    const Vec3 &x = all.position[k], &v = all.velocity[k], &w = all.spin[k];
    atoms += fmt::format("{} 1 {} 2500 {} {} {} 0 0 0\n", atom(k), 2.0 * all.radius[k], x[0] - 0.25, x[1], x[2]);
    velocities += fmt::format("{} {} {} {} {} {} {}\n", atom(k), v[0], v[1], v[2], w[0], w[1], w[2]);
  }
  return fmt::format(
      "written by hand\n\n{} atoms\n1 atom types\n\n-0.25 0.05 xlo xhi\n-1 1 ylo yhi\n0 2 zlo zhi\n\nAtoms # "
      "sphere\n\n{}\nVelocities\n\n{}",
      all.id.size(), atoms, velocities);
}

TEST_F(StartText, CsvIsTakenOverToTheBit) {
  (void)make(comm_, "base", "", {});
  const pack::PackRows before = rows("base");
  write("base.csv", csv_of(before));
  const report::RunRecord record = go_on("base.csv", nothing_moves);
  const pack::PackRows after = rows("next");
  EXPECT_EQ(record.steps, 0);
  EXPECT_EQ(after.id, before.id);
  EXPECT_EQ(after.position, before.position);
  EXPECT_EQ(after.radius, before.radius);
  EXPECT_EQ(after.velocity, before.velocity);
  EXPECT_EQ(after.contacts, before.contacts);
  EXPECT_THAT(record.start, HasSubstr(": " + std::to_string(before.id.size()) +
                                      " particles in 1 layer taken over, with positions, radii, velocities, spins; "
                                      "not taken over: 1 other column, what contacts remember, time and counters"));
  EXPECT_THAT(record.effective_input, HasSubstr("digest = \""));
}

TEST_F(StartText, LammpsIsTakenOverWithItsBoxAndVelocities) {
  (void)make(comm_, "base", "", {});
  const pack::PackRows before = rows("base");
  write("base.data", lammps_of(before));
  const report::RunRecord record = go_on("base.data", nothing_moves);
  const pack::PackRows after = rows("next");
  EXPECT_EQ(after.radius, before.radius);
  EXPECT_EQ(after.velocity, before.velocity);
  for (std::size_t k = 0; k < before.id.size(); ++k) {
    EXPECT_NEAR(after.position[k][0], before.position[k][0], 1e-15);
    EXPECT_EQ(after.position[k][1], before.position[k][1]);
    EXPECT_EQ(after.position[k][2], before.position[k][2]);
  }
  EXPECT_THAT(record.start,
              HasSubstr("not taken over: atom ids, types, densities, what contacts remember, time and counters"));
}

TEST_F(StartText, MoreLayersComeOnTopAndAreTheSameOnAnyRanks) {
  (void)make(comm_, "base", "", {});
  const pack::PackRows before = rows("base");
  write("base.csv", csv_of(before));
  const std::vector<std::string> higher{"container.size=[0.3, 0.3, 0.14]"};
  const report::RunRecord record = go_on("base.csv", higher);
  EXPECT_TRUE(record.targets_met) << ::testing::PrintToString(record.missed);
  const pack::PackRows after = rows("next");
  EXPECT_GT(after.id.size(), before.id.size());
  if (comm_.rank() == 0) {
    const comm::Comm alone(MPI_COMM_SELF);
    (void)make(alone, "alone", "[start]\npack = \"base.csv\"\n", higher);
    const pack::PackRows one = rows("alone");
    EXPECT_EQ(after.position, one.position);
    EXPECT_EQ(after.velocity, one.velocity);
  }
  comm_.barrier();
}

TEST_F(StartText, OverlapsWithinTheBoundAreRelaxed) {
  // A row of spheres along the periodic axis, 15 of radius 0.0104 where 0.01 would touch: each overlaps by 0.077 of its
  // radius, and two by more.
  std::string text = "x,y,z,r\n";
  for (int k = 0; k < 15; ++k) text += fmt::format("{},0.15,0.0104,0.0104\n", 0.02 * k + (k == 7 ? 0.0101 : 0.01));
  const std::vector<std::string> small{"particles.radius.min=0.01", "start.overlap_limit=0.1",
                                       "container.size=[0.3, 0.3, 0.06]"};
  write("row.csv", text);
  const report::RunRecord record = go_on("row.csv", small);
  EXPECT_LT(record.audit.worst_overlap, 0.02);
  EXPECT_TRUE(record.targets_met) << ::testing::PrintToString(record.missed);
  EXPECT_THAT(complaint(text, {"particles.radius.min=0.01"}),
              HasSubstr("its deepest overlap is 0.0865 radii, of particles 7 and 8 (lines 9 and 10) at (0.1501, 0.15, "
                        "0.0104) m; start.overlap_limit is 0.05: raise that, or give a pack that is at rest"));
}

TEST_F(StartText, WhatDoesNotFitIsRefused) {
  const std::string next = (folder_ / "next.toml").string() + ": start.pack: ";
  EXPECT_EQ(complaint("x,y,z,r\n0.1,0.1,0.01,0.02\n"),
            next +
                "its deepest overlap is 0.5 radii, of particle 0 (line 2) at (0.1, 0.1, 0.01) m, in a wall; "
                "start.overlap_limit is 0.05: raise that, or give a pack that is at rest");
  EXPECT_EQ(complaint("x,y,z,r\n0.1,0.1,-0.01,0.02\n"),
            next + "1 particles have centres outside the container, whose corner is at 0 and whose floor is at z = 0");
  EXPECT_EQ(complaint("0.1,0.1,0.1,0.03\n"),
            next +
                "its radii are 0.03 to 0.03 m, those of the scene 0.015 to 0.02 m; give particles.radius a range "
                "that has both");
  EXPECT_EQ(complaint("x,y,z\n1,2,3\n"), (folder_ / "bad.csv").string() +
                                             ":1: there is no column radius; name the columns, such as "
                                             "\"x,y,z,radius\"");
  EXPECT_EQ(
      complaint("0.1,0.1,0.1,0.02\n", {"start.digest=0123456789abcdef"}).find("start.digest: is 0123456789abcdef") !=
          std::string::npos,
      true);
  EXPECT_EQ(complaint("x,y,z,r\n0.1,0.1,0.1,0.02\n", {}, two_components),
            next +
                "particles of a text file are of one material, and the scene has several components; go on from a pack "
                "(.hdf)");
  write("box.data",
        "title\n\n1 atoms\n0 1 xlo xhi\n0 1 ylo yhi\n0 1 zlo zhi\n\nAtoms # sphere\n\n1 1 0.04 1 0.1 0.1 0.1\n");
  try {
    (void)go_on("box.data", {});
    ADD_FAILURE() << "the box is another";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()), next +
                                             "its box is 1 m along x, which is periodic, and the container 0.3 m; give "
                                             "container.size that of the box");
  }
}

}  // namespace
}  // namespace packmpi::run
