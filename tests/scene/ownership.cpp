// Who owns which column: a partition of the grid, whichever way it was made; neighbours are mutual; balance pays.
#include "scene/ownership.hpp"

#include <gtest/gtest.h>

#include <set>

#include "support/scenes.hpp"

namespace packmpi::scene {
namespace {

using input::Decomposition;
constexpr std::array kinds{Decomposition::slab, Decomposition::pencil, Decomposition::metis};

geometry::ColumnGrid grid_of(int dimension, double lx, double ly, bool periodic, double reach) {
  geometry::Container box;
  box.dimension = dimension;
  box.size = dimension == 3 ? Vec3{lx, ly, 1.0} : Vec3{lx, 1.0, 0.0};
  box.periodic = {periodic, periodic && dimension == 3};
  return {box, reach};
}

// Every column has one owner, and columns() of all ranks together are the grid.
void expect_partition(const comm::Comm& comm, const Ownership& ownership) {
  std::vector<std::int64_t> claims(static_cast<std::size_t>(ownership.grid().size()), 0);
  for (const auto column : ownership.columns()) {
    EXPECT_EQ(ownership.owner(column), comm.rank());
    ++claims[static_cast<std::size_t>(column)];
  }
  EXPECT_FALSE(ownership.columns().empty());
  comm.sum(claims);
  for (const std::int64_t c : claims) EXPECT_EQ(c, 1);
}

// neighbors() by brute force over all columns.
void expect_neighbors(const comm::Comm& comm, const Ownership& ownership) {
  std::set<Rank> expected;
  std::vector<geometry::ColumnIndex> touching;
  for (geometry::ColumnIndex c = 0; c < ownership.grid().size(); ++c) {
    if (ownership.owner(c) != comm.rank()) continue;
    ownership.grid().neighbors(c, touching);
    for (const auto other : touching) {
      if (ownership.owner(other) != comm.rank()) expected.insert(ownership.owner(other));
    }
  }
  EXPECT_EQ(std::vector<Rank>(ownership.neighbors().begin(), ownership.neighbors().end()),
            std::vector<Rank>(expected.begin(), expected.end()));
}

TEST(Ownership, IsAPartitionWithMutualNeighbors) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const Decomposition kind : kinds) {
    for (const bool periodic : {false, true}) {
      for (const int dimension : {2, 3}) {
        const Ownership ownership(comm, grid_of(dimension, 1.0, 0.7, periodic, 0.1), kind);
        expect_partition(comm, ownership);
        expect_neighbors(comm, ownership);
      }
    }
  }
}

TEST(Ownership, SlabsCutTheLongerAxis) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const Ownership ownership(comm, grid_of(3, 0.5, 2.0, false, 0.1), Decomposition::slab);
  std::set<geometry::ColumnIndex> rows;
  for (const auto c : ownership.columns()) rows.insert(c / 5);
  EXPECT_EQ(ownership.columns().size(), rows.size() * 5);  // whole rows along x
}

TEST(Ownership, RefusesMoreRanksThanColumnsNamingTheLargestCount) {
  const comm::Comm comm(MPI_COMM_WORLD);
  if (comm.size() < 3) GTEST_SKIP() << "needs three ranks";
  try {
    const Ownership ownership(comm, grid_of(3, 1.0, 1.0, false, 0.5), Decomposition::slab);
    FAIL() << "two columns for " << comm.size() << " ranks";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    EXPECT_NE(std::string(error.what()).find("use at most 2 ranks, or decomposition = \"pencil\" (at most 4 ranks)"),
              std::string::npos)
        << error.what();
  }
}

TEST(Ownership, RebalanceEvensOutAGradientAndKeepsThePartition) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const Decomposition kind : kinds) {
    Ownership ownership(comm, grid_of(3, 2.0, 2.0, false, 0.1), kind);
    const auto weight = [](geometry::ColumnIndex c) { return std::int64_t{10} + 10 * (c % 20); };
    std::vector<std::int64_t> mine;
    for (const auto c : ownership.columns()) mine.push_back(weight(c));
    const auto load = [&] {
      std::int64_t sum = 0;
      for (const auto c : ownership.columns()) sum += weight(c);
      return comm.max(sum);
    };
    const std::int64_t before = load();
    const bool changed = ownership.rebalance(mine);
    expect_partition(comm, ownership);
    expect_neighbors(comm, ownership);
    EXPECT_EQ(changed, load() != before);
    EXPECT_LE(load(), before);
    if (kind != Decomposition::slab) continue;
    EXPECT_LT(static_cast<double>(load()), 1.25 * 42000.0 / comm.size() + 4000.0);
  }
}

}  // namespace
}  // namespace packmpi::scene
