// Sums that depend on nothing but their terms, against two slow oracles.
#include "comm/exact_sum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <vector>

namespace packmpi::comm {
namespace {

__extension__ using Int128 = __int128;

constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double denormal = std::numeric_limits<double>::denorm_min();

/// Bits, not values: -0 is not +0 and a NaN is itself.
std::uint64_t bits(double x) { return std::bit_cast<std::uint64_t>(x); }

/// This rank's share of a list that all ranks know: term k to rank (k * stride + shift) mod size.
std::vector<double> share(const Comm& comm, const std::vector<double>& all, std::size_t shift) {
  std::vector<double> mine;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (static_cast<int>((k + shift) % static_cast<std::size_t>(comm.size())) == comm.rank()) mine.push_back(all[k]);
  }
  return mine;
}

double spread_sum(const Comm& comm, const std::vector<double>& all) { return exact_sum(comm, share(comm, all, 0)); }

/// Numbers m 2^e of random sign, m of 53 bits, e uniform in [lowest, highest].
std::vector<double> numbers(std::uint64_t seed, std::size_t count, int lowest, int highest) {
  std::mt19937_64 random(seed);
  std::vector<double> all(count);
  for (double& x : all) {
    const double mantissa = static_cast<double>((random() >> 12U) | (std::uint64_t{1} << 52U)) * 0x1p-53;
    const int exponent = lowest + static_cast<int>(random() % static_cast<std::uint64_t>(highest - lowest + 1));
    x = std::ldexp(random() % 2 == 0 ? mantissa : -mantissa, exponent);
  }
  return all;
}

/// Oracle 1: terms that are multiples of 2^-60 and below 2^20 add without any rounding.
double oracle_of_multiples(const std::vector<double>& all) {
  Int128 sum = 0;
  for (const double x : all) sum += static_cast<Int128>(std::ldexp(static_cast<long double>(x), 60));
  return std::ldexp(static_cast<double>(sum), -60);
}

/// Oracle 2: Shewchuk's growing expansion, exact for any terms; then its parts from the smallest on.
long double oracle_of_any(const std::vector<double>& all) {
  std::vector<double> parts;
  for (double x : all) {
    std::vector<double> grown;
    for (double part : parts) {
      if (std::fabs(x) < std::fabs(part)) std::swap(x, part);
      const double high = x + part;
      const double low = part - (high - x);
      if (low != 0.0) grown.push_back(low);
      x = high;
    }
    grown.push_back(x);
    parts = grown;
  }
  long double sum = 0.0L;
  for (const double part : parts) sum += part;
  return sum;
}

TEST(ExactSum, AgreesWithIntegersBitForBit) {
  const Comm comm(MPI_COMM_WORLD);
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const std::vector<double> all = numbers(seed, 1 + seed * 7, -7, 20);  // 2^-60 = lowest bit of 2^-7 with 53 bits
    ASSERT_EQ(bits(spread_sum(comm, all)), bits(oracle_of_multiples(all))) << seed;
  }
}

TEST(ExactSum, AgreesWithAnExpansionAtAnyMagnitude) {
  const Comm comm(MPI_COMM_WORLD);
  for (const auto& [lowest, highest] : {std::pair{-300, 300}, {-40, 0}, {-1070, -960}, {900, 1000}, {-5, 5}}) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      const std::vector<double> all = numbers(seed, 200, lowest, highest);
      const long double expected = oracle_of_any(all);
      const long double allowed =
          std::fabs(expected) * 0x1p-53L * 1.001L;  // half a unit, and the oracle's own rounding
      ASSERT_LE(std::fabs(spread_sum(comm, all) - expected), allowed) << lowest << " " << seed;
    }
  }
}

TEST(ExactSum, SameBitsForAnyOrderAndAnyShares) {
  const Comm comm(MPI_COMM_WORLD);
  std::vector<double> all = numbers(9, 3000, -120, 40);
  const Comm alone(MPI_COMM_SELF);
  const std::uint64_t expected = bits(exact_sum(alone, all));
  std::mt19937_64 random(10);
  for (int round = 0; round < 20; ++round) {
    std::shuffle(all.begin(), all.end(), random);
    ASSERT_EQ(bits(spread_sum(comm, all)), expected);
    std::vector<double> mine;  // all on one rank, the others with nothing
    if (comm.rank() == round % comm.size()) mine = all;
    ASSERT_EQ(bits(exact_sum(comm, mine)), expected);
    const std::size_t cut = all.size() / 3;  // zeros and pairs that cancel change nothing
    mine = share(comm, all, cut);
    mine.insert(mine.end(), {0.0, -0.0, 1e-3, -1e-3});
    ASSERT_EQ(bits(exact_sum(comm, mine)), expected);
  }
}

TEST(ExactSum, Cancellations) {
  const Comm comm(MPI_COMM_WORLD);
  EXPECT_EQ(spread_sum(comm, {1e16, 1.0, -1e16}), 1.0);
  EXPECT_EQ(spread_sum(comm, {1.0, 0x1p-52, -1.0}), 0x1p-52);
  EXPECT_EQ(spread_sum(comm, {0x1p43, 0x1p-52, -0x1p43}), 0x1p-52);
  EXPECT_EQ(spread_sum(comm, {1e300, 1e-300, denormal, -1e300}), 1e-300);  // 1e-300 + 5e-324 is 1e-300
  EXPECT_EQ(bits(spread_sum(comm, {0.1, -0.1})), bits(0.0));
  EXPECT_EQ(bits(spread_sum(comm, {-0.1, 0.1})), bits(0.0));
  std::vector<double> all = numbers(4, 1000, -200, 0);
  const std::size_t n = all.size();
  for (std::size_t k = 0; k < n; ++k) all.push_back(-all[k]);
  EXPECT_EQ(bits(spread_sum(comm, all)), bits(0.0));  // rounding is the same for both signs
}

TEST(ExactSum, RoundsOnceToTheNearestEven) {
  const Comm comm(MPI_COMM_WORLD);
  EXPECT_EQ(spread_sum(comm, {1.0, 0x1p-53}), 1.0);
  EXPECT_EQ(spread_sum(comm, {1.0, 0x1p-53, denormal}), 1.0 + 0x1p-52);  // the least bit decides
  EXPECT_EQ(spread_sum(comm, {1.0, 0x1p-53, -denormal}), 1.0);
  EXPECT_EQ(spread_sum(comm, {-1.0, -0x1p-53, -denormal}), -1.0 - 0x1p-52);
  EXPECT_EQ(spread_sum(comm, {1.0, 0x1p-52, 0x1p-53}), 1.0 + 0x1p-51);
  EXPECT_EQ(spread_sum(comm, {1.0, 0x1p-95, -1.0}), 0x1p-95);
}

TEST(ExactSum, ManyEqualTermsFillTheTopLimb) {
  const Comm comm(MPI_COMM_WORLD);
  const std::vector<double> mine(1U << 16U, -0x1.fffffffffffffp0);
  EXPECT_EQ(exact_sum(comm, mine), -0x1.fffffffffffffp16 * comm.size());
}

// What thousands of ranks would add up to, word by word.
TEST(ExactSum, OfThousandsOfRanks) {
  const auto sum = [](std::initializer_list<std::pair<double, int>> terms) {  // a rank's sum, on so many ranks
    ExactSum all;
    for (const auto& [term, ranks] : terms) {
      ExactSum one;
      one.add(term);
      one.settle();
      for (int k = 0; k < ranks; ++k) {
        for (std::size_t w = 0; w < one.words().size(); ++w) all.words()[w] += one.words()[w];
      }
    }
    return all.round();
  };
  const double max = std::numeric_limits<double>::max();
  EXPECT_EQ(sum({{0x1p30, 1000}}), 1000 * 0x1p30);
  EXPECT_EQ(sum({{-0x1p30, 1000}}), -1000 * 0x1p30);
  EXPECT_EQ(sum({{0x1p30, 5000}, {-0x1p30, 5000}, {-denormal, 3}}), -3.0 * denormal);
  EXPECT_EQ(bits(sum({{0x1p30, 7}, {-0x1p30, 7}})), bits(0.0));
  EXPECT_EQ(sum({{max, 5000}, {-max, 4999}}), max);
  EXPECT_EQ(sum({{-max, 5000}}), -inf);
  EXPECT_EQ(sum({{0x1p30, 128}, {0x1p-16, 1}}), 0x1p37);  // between two doubles
  EXPECT_EQ(sum({{0x1p30, 128}, {0x1p-16, 1}, {denormal, 1}}), 0x1.0000000000001p37);
  EXPECT_EQ(sum({{-0x1p30, 128}, {-0x1p-16, 1}, {-denormal, 1}}), -0x1.0000000000001p37);
  EXPECT_TRUE(std::isnan(sum({{1.0, 3}, {inf, 1}})));
}

TEST(ExactSum, EndsOfTheRange) {
  const Comm comm(MPI_COMM_WORLD);
  const double max = std::numeric_limits<double>::max();
  EXPECT_EQ(spread_sum(comm, {max}), max);
  EXPECT_EQ(spread_sum(comm, {max, max, -max}), max);
  EXPECT_EQ(spread_sum(comm, {max, max}), inf);
  EXPECT_EQ(spread_sum(comm, {-max, -max}), -inf);
  EXPECT_EQ(spread_sum(comm, {max, denormal}), max);
  EXPECT_EQ(spread_sum(comm, {denormal}), denormal);
  EXPECT_EQ(spread_sum(comm, {denormal, denormal, -denormal * 5}), -denormal * 3);
  EXPECT_EQ(spread_sum(comm, {0x1p-1022, -denormal}), 0x1p-1022 - denormal);
}

TEST(ExactSum, NothingAndNothingFinite) {
  const Comm comm(MPI_COMM_WORLD);
  EXPECT_EQ(bits(exact_sum(comm, std::span<const double>{})), bits(0.0));
  EXPECT_EQ(bits(spread_sum(comm, {-0.0, -0.0, 0.0})), bits(0.0));
  for (const double bad : {inf, -inf, std::numeric_limits<double>::quiet_NaN()}) {
    std::vector<double> all(9, 1.0);
    for (double& place : all) {
      place = bad;
      EXPECT_TRUE(std::isnan(spread_sum(comm, all)));
      place = 1.0;
    }
  }
  EXPECT_TRUE(std::isnan(spread_sum(comm, {inf, -inf})));
}

TEST(ExactSums, EachIsItsOwnSum) {
  const Comm comm(MPI_COMM_WORLD);
  const std::vector<std::vector<double>> mine{numbers(static_cast<std::uint64_t>(comm.rank()), 100, -20, 20),
                                              {},
                                              {inf},
                                              {1e-200},
                                              numbers(static_cast<std::uint64_t>(comm.rank()), 10, 500, 520)};
  std::vector<ExactSum> added(mine.size());
  for (std::size_t k = 0; k < mine.size(); ++k) {
    for (const double term : mine[k]) added[k].add(term);
  }
  const std::vector<double> sums = exact_sums(comm, added);
  ASSERT_EQ(sums.size(), 5U);
  EXPECT_EQ(bits(sums[0]), bits(exact_sum(comm, mine[0])));
  EXPECT_EQ(bits(sums[1]), bits(0.0));
  EXPECT_TRUE(std::isnan(sums[2]));
  EXPECT_EQ(bits(sums[3]), bits(exact_sum(comm, mine[3])));
  EXPECT_EQ(bits(sums[4]), bits(exact_sum(comm, mine[4])));
  EXPECT_TRUE(exact_sums(comm, {}).empty());
}

}  // namespace
}  // namespace packmpi::comm
