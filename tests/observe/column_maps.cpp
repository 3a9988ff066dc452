/// Maps over lateral columns: by hand, against the measures of the whole pack, and on any number of ranks.
#include "observe/column_maps.hpp"

#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <numeric>

#include "comm/exact_sum.hpp"
#include "support/scattered.hpp"

namespace packmpi::observe {
namespace {

using testing::every_spread;
using testing::Grain;
using testing::Spread;

class Maps : public ::testing::Test {
 protected:
  comm::Comm comm_{MPI_COMM_WORLD};
  scene::Scene scene_ = testing::make_scene(3, {2.1, 1.3, 0.5}, {true, false}, 0.05);

  [[nodiscard]] static std::vector<Grain> cloud(std::size_t count) {
    testing::Scatter next;
    std::vector<Grain> grains(count);
    for (Grain& g : grains) {
      g = {{2.1 * next(), 1.3 * next(), 0.6 * next()}, 0.03 + 0.02 * next()};
    }
    return grains;
  }
  [[nodiscard]] ColumnMaps maps(const comm::Comm& comm, const std::vector<Grain>& grains, Spread spread) const {
    const particles::Store store = testing::scattered(comm, scene_.features.layout(), grains, spread);
    return column_maps(comm, store, scene_, testing::all_pairs(store));
  }
};

TEST_F(Maps, OneTouchingPairIsInItsColumns) {
  // Columns a little wider than 0.4 m: 5 x 3. The pair stands one above the other; its middle is in column 3 + 5 * 1.
  const double overlap = 1e-4;
  const std::vector<Grain> grains{{{1.3, 0.5, 0.1}, 0.05}, {{1.3, 0.5, 0.2 - overlap}, 0.05}};
  const ColumnMaps here = maps(comm_, grains, Spread::all);
  EXPECT_EQ(here.counts, (std::array<std::int64_t, 2>{5, 3}));
  EXPECT_DOUBLE_EQ(here.widths[0], 2.1 / 5);
  EXPECT_DOUBLE_EQ(here.widths[1], 1.3 / 3);
  const std::int64_t before = comm_.sum_below(std::ssize(here.top));
  EXPECT_EQ(comm_.sum(std::ssize(here.top)), 15);
  const double volume = 2.1 * 1.3 * 0.5 / 15, modulus = 1.0e8 / (2.0 * (1.0 - 0.0625));
  const double force = 4.0 / 3.0 * std::sqrt(0.025) * modulus * std::pow(overlap, 1.5);
  for (std::size_t k = 0; k < here.top.size(); ++k) {
    const bool mine = before + static_cast<std::int64_t>(k) == 3 + 5;
    const double solid = 2.0 * 4.0 / 3.0 * std::acos(-1.0) * 0.05 * 0.05 * 0.05;
    EXPECT_DOUBLE_EQ(here.top[k], mine ? 0.25 - overlap : 0.0);
    EXPECT_NEAR(here.solid_fraction[k], mine ? solid / volume : 0.0, 1e-14);
    const double stress = force * (0.1 - overlap) / volume;
    EXPECT_NEAR(here.vertical_stress[k], mine ? stress : 0.0, 1e-10 * stress) << "compression is positive";
  }
}

TEST_F(Maps, AddUpToTheMeasuresOfTheWholePack) {
  const std::vector<Grain> grains = cloud(400);
  const particles::Store store = testing::scattered(comm_, scene_.features.layout(), grains, Spread::all);
  const ColumnMaps here = maps(comm_, grains, Spread::all);
  const double mean = comm::exact_sum(comm_, here.solid_fraction) / static_cast<double>(map_columns(scene_));
  EXPECT_NEAR(mean, density(comm_, store, scene_, bulk_of(scene_, 1.0)).phi, 1e-13);
  double highest = 0.0;
  for (const double one : here.top) highest = std::max(highest, one);
  EXPECT_EQ(comm_.max(highest), top(comm_, store, scene_));
  double virial = 0.0;  // of all contacts below H_d, each by the rank that tells it
  each_contact(store, scene_, testing::all_pairs(store), {}, [&](const ContactForce& c) {
    if (c.middle[2] < 0.5) virial -= c.force[2] * c.branch[2];
  });
  const double all = comm::exact_sum(comm_, std::array{virial});
  const double volume = 2.1 * 1.3 * 0.5 / static_cast<double>(map_columns(scene_));
  EXPECT_NEAR(comm::exact_sum(comm_, here.vertical_stress) * volume, all, 1e-10 * all);
  EXPECT_GT(all, 0.0);
}

TEST_F(Maps, EndAtALidBelowTheHeight) {
  scene_.container.lid = 0.4;
  const std::vector<Grain> grains = cloud(400);
  const particles::Store store = testing::scattered(comm_, scene_.features.layout(), grains, Spread::all);
  const ColumnMaps here = maps(comm_, grains, Spread::all);
  const auto columns = static_cast<double>(map_columns(scene_));
  EXPECT_NEAR(comm::exact_sum(comm_, here.solid_fraction) / columns,
              density(comm_, store, scene_, bulk_of(scene_, 1.0)).phi, 1e-13);
  double virial = 0.0;
  each_contact(store, scene_, testing::all_pairs(store), {}, [&](const ContactForce& c) {
    if (c.middle[2] < 0.4) virial -= c.force[2] * c.branch[2];
  });
  const double all = comm::exact_sum(comm_, std::array{virial});
  EXPECT_NEAR(comm::exact_sum(comm_, here.vertical_stress) * 2.1 * 1.3 * 0.4 / columns, all, 1e-10 * all);
}

TEST_F(Maps, AreTheSameHoweverTheParticlesAreSpread) {
  const std::vector<Grain> grains = cloud(400);
  const ColumnMaps alone = maps(comm::Comm(MPI_COMM_SELF), grains, Spread::last);
  for (const Spread spread : every_spread) {
    const ColumnMaps here = maps(comm_, grains, spread);
    const auto before = static_cast<std::size_t>(comm_.sum_below(std::ssize(here.top)));
    for (std::size_t k = 0; k < here.top.size(); ++k) {
      EXPECT_EQ(here.top[k], alone.top[before + k]);
      EXPECT_EQ(here.solid_fraction[k], alone.solid_fraction[before + k]);
      EXPECT_EQ(here.vertical_stress[k], alone.vertical_stress[before + k]);
    }
  }
}

}  // namespace
}  // namespace packmpi::observe
