// Splitting weighted columns: never an empty part, nearly equal weights, the guards around METIS.
#include "scene/partition.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace packmpi::scene {
namespace {

std::vector<std::int64_t> ramp(std::size_t n) {
  std::vector<std::int64_t> w(n);
  std::iota(w.begin(), w.end(), 1);
  return w;
}

TEST(CutLine, EveryPartHasACellAndAllCellsAreUsed) {
  for (std::size_t cells = 1; cells <= 12; ++cells) {
    for (int parts = 1; parts <= static_cast<int>(cells); ++parts) {
      for (const auto& weights :
           {std::vector<std::int64_t>(cells, 0), ramp(cells), std::vector<std::int64_t>(cells, 1000000)}) {
        const auto cuts = cut_line(weights, parts);
        ASSERT_EQ(cuts.size(), static_cast<std::size_t>(parts) + 1);
        EXPECT_EQ(cuts.front(), 0);
        EXPECT_EQ(cuts.back(), static_cast<int>(cells));
        for (std::size_t p = 0; p + 1 < cuts.size(); ++p) EXPECT_LT(cuts[p], cuts[p + 1]);
      }
    }
  }
}

TEST(CutLine, SharesDifferByAtMostTheHeaviestCell) {
  const auto weights = ramp(100);
  const auto cuts = cut_line(weights, 7);
  const double ideal = (5050.0 + 100.0) / 7.0;
  for (std::size_t p = 0; p < 7; ++p) {
    double share = 0.0;
    for (int k = cuts[p]; k < cuts[p + 1]; ++k)
      share += static_cast<double>(weights[static_cast<std::size_t>(k)]) + 1.0;
    EXPECT_NEAR(share, ideal, 101.0) << p;
  }
}

TEST(CutLine, NothingAndEqualWeightsAreCutIntoEqualLengths) {
  for (const std::int64_t weight : {0, 1, 1000}) {
    EXPECT_EQ(cut_line(std::vector<std::int64_t>(12, weight), 3), (std::vector<int>{0, 4, 8, 12})) << weight;
  }
  EXPECT_EQ(cut_line(std::vector<std::int64_t>{9, 0, 0, 0, 0, 0, 0, 0, 0, 9}, 2), (std::vector<int>{0, 5, 10}));
}

TEST(CutLine, OneHeavyCellAtTheEndLeavesTheOthersAColumnEach) {
  std::vector<std::int64_t> weights(5, 0);
  weights.back() = 1000000;
  EXPECT_EQ(cut_line(weights, 5), (std::vector<int>{0, 1, 2, 3, 4, 5}));
}

TEST(FactorRanks, FitsTheGridOrSaysNo) {
  const auto square = factor_ranks(4, 10, 10, 1.0, 1.0);
  ASSERT_TRUE(square);
  EXPECT_EQ(square->x, 2);
  EXPECT_EQ(square->y, 2);
  const auto flat = factor_ranks(6, 10, 1, 1.0, 0.0);  // 2D
  ASSERT_TRUE(flat);
  EXPECT_EQ(flat->x, 6);
  EXPECT_FALSE(factor_ranks(7, 6, 6, 1.0, 1.0));
  EXPECT_FALSE(factor_ranks(101, 10, 10, 1.0, 1.0));
}

void expect_full(const std::vector<Rank>& part, int parts) {
  std::vector<int> count(static_cast<std::size_t>(parts), 0);
  for (const Rank p : part) {
    ASSERT_GE(p, 0);
    ASSERT_LT(p, parts);
    ++count[static_cast<std::size_t>(p)];
  }
  for (const int n : count) EXPECT_GT(n, 0);
}

TEST(Metis, EveryPartIsFilledEvenWhereMetisFails) {
  for (const int n : {1, 2, 3, 4, 8}) {
    for (const std::int64_t weight :
         {std::int64_t{0}, std::int64_t{1}, std::int64_t{1} << 40}) {  // sums beyond 2^31 too
      TileGrid grid{n, n, false, true, std::vector<std::int64_t>(static_cast<std::size_t>(n * n), weight)};
      for (int parts = 1; parts <= n * n; ++parts) expect_full(partition_tiles(grid, parts), parts);
    }
  }
}

TEST(Metis, BalancesAGradientAndIsDeterministic) {
  TileGrid grid{16, 16, true, true, {}};
  for (int iy = 0; iy < 16; ++iy) {
    for (int ix = 0; ix < 16; ++ix) grid.weights.push_back(1000 + 60 * ix);
  }
  const auto part = partition_tiles(grid, 8);
  EXPECT_EQ(part, partition_tiles(grid, 8));
  std::vector<double> share(8, 0.0);
  double total = 0.0;
  for (std::size_t k = 0; k < part.size(); ++k) {
    share[static_cast<std::size_t>(part[k])] += static_cast<double>(grid.weights[k]);
    total += static_cast<double>(grid.weights[k]);
  }
  for (const double s : share) EXPECT_LT(s, 1.05 * total / 8.0);
}

}  // namespace
}  // namespace packmpi::scene
