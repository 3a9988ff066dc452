// Mixtures on a lattice, whose composition, mixing and boundaries are worked out by hand.
#include "observe/composition.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "scene/mixture.hpp"
#include "support/scattered.hpp"

namespace packmpi::observe {
namespace {

using testing::Grain;
using testing::Spread;

constexpr int side = 10;
constexpr double spacing = 0.1, r = 0.05;  // touching spheres in a unit cube
using Rule = std::function<int(int, int, int)>;

class Mixtures : public ::testing::Test {
 protected:
  Mixtures() {
    scene_.features.mixture = true;
    for (const char* name : {"a", "b"}) {
      input::Component of;
      of.name = name, of.share = 1.0, of.particles = scene_.in.particles;
      of.particles.density = scene_.in.components.empty() ? 1000.0 : 3000.0;
      scene_.in.components.push_back(of);
    }
    scene_.in.strata.resize(2);
    scene_.in.strata[0].name = "low", scene_.in.strata[0].top = 0.5;
    scene_.in.strata[1].name = "high";
  }

  /// Of the lattice whose point (i, j, k) is of the component, and of the stratum, that the rules say.
  [[nodiscard]] Composition of(const Rule& component, const Rule& stratum, Spread spread = Spread::all,
                               const Bulk& bulk = {0.0, 1.0}) const {
    std::vector<Grain> grains;
    std::vector<int> components, strata;
    for (int k = 0; k < side; ++k) {
      for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
          grains.push_back({{(i + 0.5) * spacing, (j + 0.5) * spacing, (k + 0.5) * spacing}, r});
          components.push_back(component(i, j, k));
          strata.push_back(stratum(i, j, k));
        }
      }
    }
    particles::Store store = testing::scattered(comm_, scene_.features.layout(), grains, spread);
    std::vector<std::int32_t> stratum_of;
    for (LocalIndex i = 0; i < store.owned(); ++i) {
      const auto id = static_cast<std::size_t>(store.ids()[static_cast<std::size_t>(i)]);
      store.set_substance(i, scene::substance_of(scene_.in, components[id], r));
      stratum_of.push_back(strata[id]);
    }
    return composition(comm_, store, scene_, bulk, stratum_of);
  }

  comm::Comm comm_{MPI_COMM_WORLD};
  scene::Scene scene_ = testing::make_scene(3, {1.0, 1.0, 1.0}, {true, true}, r);
};

int half(int, int, int k) { return k < side / 2 ? 0 : 1; }

// p = 21/40: s0^2 = .249375; s^2 = (4/10 + 100/20 + 81/10 - 441/40) / 40 = .061875; sr^2 = 2 s0^2 / 40 = .01246875.
// Without one cell each the index is 5310/6061, 1000/1881 and 55/58.
TEST(Lacey, IsThatWorkedOutByHand) {
  const std::vector<std::int64_t> all{10, 20, 10}, own{2, 10, 9};
  const Lacey found = lacey(all, own);
  EXPECT_NEAR(found.index, 0.1875 / 0.23690625, 1e-14);
  const double without[] = {5310.0 / 6061.0, 1000.0 / 1881.0, 55.0 / 58.0};
  const double mean = (without[0] + without[1] + without[2]) / 3.0;
  double squares = 0.0;
  for (const double one : without) squares += (one - mean) * (one - mean);
  EXPECT_NEAR(found.error, std::sqrt(2.0 / 3.0 * squares), 1e-14);
}

TEST(Lacey, IsZeroApartAndAboveOneWhereMoreEvenThanByChance) {
  const std::vector<std::int64_t> all(4, 10), apart{10, 10, 0, 0}, even(4, 5);
  EXPECT_NEAR(lacey(all, apart).index, 0.0, 1e-15);
  EXPECT_NEAR(lacey(all, apart).error, 0.0, 1e-15);
  EXPECT_NEAR(lacey(all, even).index, 0.25 / (0.25 - 3.0 * 0.25 / 40.0), 1e-14);
}

TEST(Lacey, LeavesEmptyCellsOutAndSaysWhereItCannotTell) {
  const std::vector<std::int64_t> all{10, 0, 20, 10}, own{2, 0, 10, 9};
  EXPECT_NEAR(lacey(all, own).index, 0.1875 / 0.23690625, 1e-14);
  const std::vector<std::int64_t> two{10, 0, 10}, of_two{4, 0, 6}, none(4, 0);
  EXPECT_TRUE(std::isnan(lacey(two, of_two).index)) << "two cells";
  EXPECT_TRUE(std::isnan(lacey(all, none).index)) << "nothing of it";
  EXPECT_TRUE(std::isnan(lacey(all, all).index)) << "nothing else";
}

// Binomial cells: the index of a mixture by chance is 1 within its error, two times of three.
TEST(Lacey, IsOneWithinItsErrorByChance) {
  testing::Scatter dice;
  int within = 0;
  double sum = 0.0;
  constexpr int trials = 300;
  for (int t = 0; t < trials; ++t) {
    std::vector<std::int64_t> all(100, 40), own(100, 0);
    for (std::int64_t& k : own) {
      for (int n = 0; n < 40; ++n) k += dice() < 0.3 ? 1 : 0;
    }
    const Lacey found = lacey(all, own);
    within += std::abs(found.index - 1.0) < found.error ? 1 : 0;
    sum += found.index;
  }
  EXPECT_NEAR(sum / trials, 1.0, 1e-3);
  EXPECT_NEAR(static_cast<double>(within) / trials, 0.68, 0.08);
}

TEST_F(Mixtures, CountsAndMassesAreThoseOfTheRows) {
  const Composition found = of([](int i, int, int) { return i < 3 ? 0 : 1; }, half);
  ASSERT_EQ(found.parts.size(), 2U);
  const double one = 4.0 / 3.0 * std::acos(-1.0) * r * r * r;
  EXPECT_EQ(found.parts[0].count, 300);
  EXPECT_EQ(found.parts[1].count, 700);
  EXPECT_NEAR(found.parts[0].mass, 300 * one * 1000.0, 300 * one * 1000.0 * 0x1p-32);
  EXPECT_NEAR(found.parts[1].mass, 700 * one * 3000.0, 700 * one * 3000.0 * 0x1p-32);
  ASSERT_EQ(found.shares.size(), 10U);
  for (const auto& slab : found.shares) EXPECT_NEAR(slab[0], 0.3, 1e-12);
}

// 1000 in the bulk make 2 x 2 x 2 cells of 125: halves fill whole cells; of a checkerboard a cell has 62 or 63.
TEST_F(Mixtures, LaceyIsThatOfTheCells) {
  const Composition apart = of(half, half);
  EXPECT_EQ(apart.cells, 8);
  EXPECT_DOUBLE_EQ(apart.cell, 0.5);
  EXPECT_NEAR(apart.parts[0].lacey, 0.0, 1e-14);
  const Composition even = of([](int i, int j, int k) { return (i + j + k) % 2; }, half);
  for (const ComponentPart& part : even.parts) EXPECT_NEAR(part.lacey, (0.25 - 1.6e-5) / (0.25 - 0.00175), 1e-14);
}

// A bulk less than two cells high has two of them all the same: one above the other is apart, not mixed.
TEST_F(Mixtures, ALowBedHasCellsAboveEachOther) {
  const Composition apart = of(half, half, Spread::all, {0.3, 0.7});
  EXPECT_NEAR(apart.cell, 0.2, 1e-12);
  for (const ComponentPart& part : apart.parts) EXPECT_NEAR(part.lacey, 0.0, 1e-14);
}

// Flat, the boundary is where the spheres of both sides touch; one of each exchanged is a five-hundredth of 0.5 m on
// either side, and of the boundary's height nothing.
TEST_F(Mixtures, BoundaryIsWhereTheSolidBelowIsThatOfTheStrataBelow) {
  const Composition flat = of(half, half);
  ASSERT_EQ(flat.boundaries.size(), 1U);
  EXPECT_EQ(flat.boundaries[0].below, "low");
  EXPECT_EQ(flat.boundaries[0].above, "high");
  EXPECT_EQ(flat.boundaries[0].wanted, 0.5);
  EXPECT_NEAR(flat.boundaries[0].height, 0.5, 1e-9);
  EXPECT_NEAR(flat.boundaries[0].mixed, 0.0, 1e-9);
  const auto exchanged = [](int i, int j, int k) {
    const bool one = i == 3 && j == 3 && (k == 4 || k == 5);
    return one ? 1 - half(i, j, k) : half(i, j, k);
  };
  const Composition rough = of(half, exchanged);
  EXPECT_NEAR(rough.boundaries[0].height, 0.5, 1e-9);
  EXPECT_NEAR(rough.boundaries[0].mixed, 0.001, 1e-9);
}

TEST_F(Mixtures, IsTheSameHoweverParticlesAreSpread) {
  const auto rule = [](int i, int j, int k) { return (i * 7 + j * 3 + k * k) % 3 == 0 ? 1 : 0; };
  const Composition first = of(rule, half, Spread::last);
  for (const Spread spread : testing::every_spread) {
    const Composition other = of(rule, half, spread);
    EXPECT_EQ(other.shares, first.shares);
    EXPECT_EQ(other.boundaries[0].height, first.boundaries[0].height);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(other.parts[k].mass, first.parts[k].mass);
      EXPECT_EQ(other.parts[k].lacey, first.parts[k].lacey);
      EXPECT_EQ(other.parts[k].lacey_error, first.parts[k].lacey_error);
    }
  }
}

TEST_F(Mixtures, OneMaterialHasNone) {
  scene_.features.mixture = false;
  const particles::Store store(scene_.features.layout());
  const Composition found = composition(comm_, store, scene_, {0.0, 1.0}, {});
  EXPECT_TRUE(found.parts.empty());
  EXPECT_TRUE(found.shares.empty());
}

}  // namespace
}  // namespace packmpi::observe
