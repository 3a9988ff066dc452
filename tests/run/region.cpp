// layers.region = "container": layers end at H_d, and a scene is full when no particle fits below it.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/volume.hpp"
#include "rsa/insert.hpp"
#include "run/bed.hpp"
#include "run/make_pack.hpp"
#include "scene/limits.hpp"
#include "support/packed.hpp"
#include "support/scenes.hpp"

namespace packmpi::run {
namespace {

using input::RegionRule;

// Fills in a second or two of machine time.
input::Input scene_of(int dimension, bool graded, RegionRule region) {
  const double r = 0.02;
  input::Input in =
      graded ? test::graded_input(dimension, 0.4, 0.6 * r, 1.0 / 0.6) : test::small_input(dimension, 0.4, r);
  if (dimension == 3) in.container.size = {0.4, 0.24, 0.26};
  if (dimension == 2) in.container.size = {0.8, 0.3};
  in.name = "region";
  in.layers.thickness = 0.12;
  in.layers.fraction = dimension == 3 ? 0.22 : 0.35;
  in.layers.duration = 0.6;
  in.layers.region = region;
  in.contact.damping_ratio = 0.3;
  in.dynamics.time_step = graded ? 1.5e-4 : 2e-4;
  in.output.log_every = 0.1;
  return in;
}

report::RunRecord pack(const input::Input& in) { return test::packed(in, "region"); }

class Region : public ::testing::TestWithParam<std::tuple<int, bool>> {
 protected:
  [[nodiscard]] static input::Input input_of(RegionRule region) {
    return scene_of(std::get<0>(GetParam()), std::get<1>(GetParam()), region);
  }
};

// Layer by layer: where its particles are when they are inserted, and how many there are.
TEST_P(Region, EndsAtTheHeight) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const scene::Scene scene = scene::build(input_of(RegionRule::container));
  Bed bed(comm, scene);
  const auto up = static_cast<std::size_t>(scene.container.vertical());
  const double target = scene.container.height();
  int clipped = 0, whole = 0;
  while (!bed.full()) {
    ASSERT_LT(clipped + whole, scene::most_layers(scene));
    bed.store.set_ghosts(0);
    const rsa::LayerRegion region = bed.next_region();
    EXPECT_EQ(region.clipped, region.bottom + scene.in.layers.thickness > target);
    ++(region.clipped ? clipped : whole);
    const LocalIndex before = bed.store.owned();
    const rsa::Insertion got = rsa::insert(comm, scene, bed.ownership, region, bed.store);
    for (LocalIndex i = before; i < bed.store.owned(); ++i) {
      EXPECT_LE(bed.store.position(i)[up], target - bed.store.radius(i) + 1e-15);
      EXPECT_GE(bed.store.position(i)[up], region.bottom + bed.store.radius(i) - 1e-15);
    }
    const double wanted =
        scene.in.layers.fraction * scene.container.mean_area(region.bottom, region.thickness) * region.thickness;
    if (got.inserted == got.target) {
      EXPECT_GE(got.solid_volume, wanted * (1.0 - 1e-12));
    } else {
      EXPECT_TRUE(region.clipped);
      EXPECT_LT(got.inserted, got.target);
    }
    const double largest = geometry::volume(scene.container.dimension, scene.sizes.largest());
    EXPECT_LT(got.solid_volume, wanted + largest);
    bed.progress.first_ids.push_back(bed.progress.count);
    bed.progress.count += got.inserted;
    bed.balance();
    bed.advance(3000);
  }
  EXPECT_GE(whole, 1);
  EXPECT_GE(clipped, 1);
}

TEST_P(Region, FillsTheContainerAndNoMore) {
  const report::RunRecord record = pack(input_of(RegionRule::container));
  EXPECT_TRUE(record.reached);
  EXPECT_EQ(record.stop_reason, "full");
  EXPECT_LE(record.top, record.target_height + 1e-3);
  EXPECT_GT(record.top, record.target_height - 2.0 * 0.02) << "of the largest";
  EXPECT_EQ(record.audit.found, record.audit.expected);
  for (const report::LayerRow& row : record.layers) EXPECT_LE(row.region_bottom, record.target_height - 2.0 * 0.02);
}

// As long as its region ends below H_d, a layer is that of the open region.
TEST_P(Region, ChangesNothingBelow) {
  const input::Input in = input_of(RegionRule::container);
  const report::RunRecord open = pack(input_of(RegionRule::open)), clipped = pack(in);
  EXPECT_GT(open.top, clipped.top);
  std::size_t same = 0;
  for (; same < open.layers.size(); ++same) {
    const report::LayerRow &x = open.layers[same], &y = clipped.layers.at(same);
    EXPECT_EQ(x.region_bottom, y.region_bottom);
    if (x.region_bottom + in.layers.thickness > in.container.size.back()) break;
    EXPECT_EQ(x.inserted, y.inserted);
    EXPECT_EQ(x.top, y.top);
    EXPECT_EQ(x.kinetic_per_mgd, y.kinetic_per_mgd);
  }
  ASSERT_LT(same, open.layers.size());
  EXPECT_GE(same, 1U);
  EXPECT_LT(clipped.layers[same].inserted, open.layers[same].inserted);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Region, ::testing::Combine(::testing::Values(2, 3), ::testing::Bool()));

TEST(FullContainer, IsNotReachedAfterTheMostLayersThereMayBe) {
  input::Input in = scene_of(3, false, RegionRule::container);
  in.layers.maximum = 2;
  const report::RunRecord record = pack(in);
  EXPECT_FALSE(record.reached);
  EXPECT_EQ(record.stop_reason, "layers.maximum");
  EXPECT_EQ(record.layers.size(), 2U);
}

// A final stage makes room, which is filled.
TEST(FullContainer, IsFilledUpAfterTheBedHasSunk) {
  input::Input in = scene_of(3, false, RegionRule::container);
  in.layers.duration = 0.2;  // short: much is left to the final stage
  in.dynamics.window = 1;
  in.dynamics.relaxation = 0.6;
  const report::RunRecord record = pack(in);
  EXPECT_EQ(record.stop_reason, "full");
  EXPECT_GE(record.relaxations, 1);
  EXPECT_GT(record.top, record.target_height - 2.0 * 0.02);
}

}  // namespace
}  // namespace packmpi::run
