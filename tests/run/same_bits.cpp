// The property everything parallel hangs on: one scene, one pack. The particle datasets of the pack file are identical,
// bit for bit, at 1, 2, 3, 4, 6 and 8 ranks, in all decompositions, walls and periodic, 2D and 3D, equal and graded,
// near field on and off, with a moving window and without. Runs on 8 ranks and makes smaller communicators of them;
// friction with memory on 16 as well.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <optional>

#include "base/timer.hpp"
#include "pack/pack.hpp"
#include "run/make_pack.hpp"
#include "support/scenes.hpp"

namespace packmpi::run {
namespace {

using input::Decomposition;

// Few particles, hard knocks: two layers fall, hit the floor, the walls and each other.
input::Input scene_of(int dimension, bool graded, bool periodic, bool near_field) {
  const double r = 0.02;
  input::Input in =
      graded ? test::graded_input(dimension, 0.6, 0.6 * r, 1.0 / 0.6) : test::small_input(dimension, 0.6, r);
  if (dimension == 3) in.container.size = {0.66, 0.22, 0.12};
  if (dimension == 2) in.container.size = {0.66, 0.2};
  if (periodic) in = test::periodic(in);
  if (near_field) in.near_field = input::NearField{1e-4, 2.0, 1e-6, 3.5, 0.06};
  in.name = "same_bits";
  in.layers.thickness = 0.1;
  in.layers.fraction = dimension == 3 ? 0.2 : 0.3;
  in.layers.duration = 0.03;
  in.layers.maximum = 2;
  in.layers.velocity = dimension == 3 ? Vec3{0.3, 0.2, -2.0} : Vec3{0.3, -2.0, 0.0};
  in.jamming.gravity = 10.0;
  in.drag.coefficient = 0.005;
  in.dynamics.time_step = 1e-4;
  in.output.log_every = 0.01;
  return in;
}

pack::PackRows pack_on(const comm::Comm& comm, const input::Input& in, const std::string& folder) {
  Options options;
  options.folder = folder;
  options.force = true;
  options.verbosity = log::Verbosity::quiet;
  (void)make_pack(comm, scene::build(in), options);
  return pack::read_pack(folder + "/same_bits.hdf");
}

void expect_same(const pack::PackRows& a, const pack::PackRows& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.position, b.position);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.spin, b.spin);
  EXPECT_EQ(a.radius, b.radius);
  EXPECT_EQ(a.layer, b.layer);
  EXPECT_EQ(a.contacts, b.contacts);
}

bool anything_touches(const pack::PackRows& rows) {
  return std::ranges::any_of(rows.contacts, [](std::int32_t n) { return n > 0; });
}

// A window of `window` layers, fast layers so that several land, and a final relaxation; the radius of the scene above.
input::Input window_scene(int dimension, bool graded, bool periodic, bool near_field, int window) {
  input::Input in = scene_of(dimension, graded, periodic, near_field);
  in.container.size.back() = 0.4;
  in.layers.thickness = 0.08;
  in.layers.maximum = 4;
  in.dynamics.window = window;
  in.dynamics.relaxation = 0.01;
  return in;
}

class SameBits : public ::testing::TestWithParam<std::tuple<int, bool, bool, bool>> {};

// Packs of the scene on `rank_counts`, in all decompositions; collective over 8 ranks.
void expect_one_pack(input::Input in, std::initializer_list<int> rank_counts) {
  const comm::Comm world(MPI_COMM_WORLD);
  if (world.size() != std::ranges::max(8, std::ranges::max(rank_counts))) GTEST_SKIP() << "of other ranks";
  const std::string folder =
      std::filesystem::temp_directory_path() / ("packmpi_same_bits_" + std::to_string(::getppid()));
  std::optional<pack::PackRows> reference;
  for (const int ranks : rank_counts) {
    MPI_Comm part = MPI_COMM_NULL;
    MPI_Comm_split(MPI_COMM_WORLD, world.rank() < ranks ? 0 : 1, world.rank(), &part);
    if (world.rank() < ranks) {
      const comm::Comm comm(part);
      for (const Decomposition kind : {Decomposition::slab, Decomposition::pencil, Decomposition::metis}) {
        if (ranks == 1 && kind != Decomposition::slab) continue;
        SCOPED_TRACE(::testing::Message() << ranks << " ranks, decomposition " << static_cast<int>(kind));
        in.parallel.decomposition = kind;
        pack::PackRows rows;
        try {
          rows = pack_on(comm, in, folder);
        } catch (const Error& error) {  // on every rank of the group: the others must not wait for ever
          ADD_FAILURE() << error.what();
        }
        comm.barrier();
        if (!reference) {
          EXPECT_TRUE(anything_touches(rows));
          reference = rows;
        } else {
          expect_same(*reference, rows);
        }
      }
    }
    MPI_Comm_free(&part);
    // Ranks outside the first group learn the reference from the file when they first take part.
    world.barrier();
    if (!reference) reference = pack::read_pack(folder + "/same_bits.hdf");
    world.barrier();
  }
  if (world.rank() == 0) std::filesystem::remove_all(folder);
  world.barrier();
}

TEST_P(SameBits, OnAnyRankCountInAnyDecomposition) {
  const auto [dimension, graded, periodic, near_field] = GetParam();
  const input::Input in = scene_of(dimension, graded, periodic, near_field);
  if (graded == periodic) {  // every value of each feature is among these; all counts for all scenes take too long
    expect_one_pack(in, {1, 2, 3, 4, 6, 8});
  } else {
    expect_one_pack(in, {1, 3, 8});
  }
}

// A cylinder: columns in its corners are nobody's care, and the wall turns springs from row to row.
input::Input in_a_cylinder(bool graded, bool memory) {
  input::Input in = scene_of(3, graded, false, false);
  in.container.shape = input::VesselShape::cylinder;
  in.container.diameter = 0.4;
  in.container.height = 0.12;
  in.container.size = {0.4, 0.4, 0.12};
  if (!memory) return in;
  in.contact.tangential = input::Tangential::mindlin;
  in.contact.rolling_friction = in.contact.twisting_friction = 0.1;
  in.drag.coefficient = 0.0;
  return in;
}

TEST(SameBitsInACylinder, Equal) { expect_one_pack(in_a_cylinder(false, false), {1, 2, 3, 5}); }

TEST(SameBitsInACylinder, GradedThatRemember) { expect_one_pack(in_a_cylinder(true, true), {1, 2, 3, 5}); }

TEST(SameBitsWithAWindow, OfOneLayer) { expect_one_pack(window_scene(3, false, false, false, 1), {1, 3, 8}); }

TEST(SameBitsWithAWindow, OfTwoGradedPeriodicLayers) {
  expect_one_pack(window_scene(3, true, true, false, 2), {1, 2, 4});
}

// Friction with memory, rolling and twisting: histories cross ranks, freeze, and come back.
input::Input remembering(input::Input in, double rolling) {
  in.contact.tangential = input::Tangential::mindlin;
  in.contact.rolling_friction = rolling;
  in.contact.twisting_friction = in.container.dimension == 3 ? rolling : 0.0;
  return in;
}

TEST(SameBitsWithMemory, OfEqualSpheresBetweenWalls) {
  expect_one_pack(remembering(scene_of(3, false, false, false), 0.0), {1, 2, 3, 4, 6, 8});
}

TEST(SameBitsWithMemory, OfGradedPeriodicSpheresThatRollAndTwist) {
  expect_one_pack(remembering(scene_of(3, true, true, false), 0.1), {1, 2, 3, 4, 6, 8});
}

TEST(SameBitsWithMemory, OfDiscs) {
  for (const bool graded : {true, false}) {
    input::Input in = remembering(scene_of(2, graded, !graded, false), graded ? 0.1 : 0.0);
    in.layers.duration = 0.15;  // time to come to lie on each other
    in.contact.damping_ratio = 1.0;
    expect_one_pack(in, {1, 3, 8});
  }
}

TEST(SameBitsWithMemory, WithoutRotation) {
  input::Input in = remembering(scene_of(3, false, true, false), 0.0);
  in.dynamics.rotation = false;
  expect_one_pack(in, {1, 2, 8});
}

TEST(SameBitsWithMemory, OfAWindowAndAFinalRelaxation) {
  expect_one_pack(remembering(window_scene(3, false, false, false, 1), 0.0), {1, 3, 8});
  expect_one_pack(remembering(window_scene(3, true, true, false, 2), 0.1), {1, 2, 4});
}

TEST(SameBitsWithMemory, OnSixteenRanks) {
  input::Input in = remembering(scene_of(3, true, true, false), 0.1);
  in.layers.duration = 0.02;
  in.container.size[0] = 0.8;  // slabs for all of them
  expect_one_pack(in, {1, 16});
}

// Everything that shortens a run at once: soft layers in large steps, ended when they have settled.
TEST(SameBitsWithAWindow, OfSoftLayersThatSettle) {
  input::Input in = window_scene(3, false, false, false, 1);
  in.layers.youngs_modulus = 1e7;
  in.layers.time_step = 2e-4;
  in.layers.duration = 0.08;
  in.dynamics.stop = input::StopRule::settled;
  in.dynamics.settled_energy = 0.3;
  in.dynamics.settled_drift = 0.3;
  in.dynamics.settled_hold = 0.01;
  in.dynamics.settled_force = 10.0;
  expect_one_pack(in, {1, 3, 4});
}

TEST(SameBitsWithAWindow, OfOneLayerInThePlaneWithANearField) {
  expect_one_pack(window_scene(2, true, false, true, 1), {1, 6});
}

TEST(SameBitsBelowTheHeight, OfLayersThatEndThere) {
  for (const int dimension : {2, 3}) {
    for (const bool graded : {false, true}) {
      input::Input in = scene_of(dimension, graded, graded, false);
      in.layers.region = input::RegionRule::container;
      in.layers.maximum = 0;
      expect_one_pack(in, {1, 2, 3, 5});
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, SameBits,
                         ::testing::Combine(::testing::Values(2, 3), ::testing::Bool(), ::testing::Bool(),
                                            ::testing::Bool()));

}  // namespace
}  // namespace packmpi::run
