// Philox against the authors' known answers and a textbook twin; names against collisions; numbers against a die.
#include "base/random.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace packmpi::random {
namespace {

using Four = std::array<std::uint32_t, 4>;

/// The twin: Salmon et al. 2011, section 3.3, as printed.
Four philox_oracle(Four c, std::array<std::uint32_t, 2> k) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = std::uint64_t{0xD2511F53U} * c[0];
    const std::uint64_t p1 = std::uint64_t{0xCD9E8D57U} * c[2];
    c = {static_cast<std::uint32_t>(p1 >> 32U) ^ c[1] ^ k[0], static_cast<std::uint32_t>(p1),
         static_cast<std::uint32_t>(p0 >> 32U) ^ c[3] ^ k[1], static_cast<std::uint32_t>(p0)};
    k[0] += 0x9E3779B9U;
    k[1] += 0xBB67AE85U;
  }
  return c;
}

std::array<std::uint64_t, 2> pair_words(const Four& b) {
  return {b[0] | std::uint64_t{b[1]} << 32U, b[2] | std::uint64_t{b[3]} << 32U};
}

TEST(Random, OracleGivesTheKnownAnswersOfRandom123) {
  constexpr std::uint32_t all = 0xffffffffU;
  EXPECT_EQ(philox_oracle({0, 0, 0, 0}, {0, 0}), (Four{0x6627e8d5U, 0xe169c58dU, 0xbc57ac4cU, 0x9b00dbd8U}));
  EXPECT_EQ(philox_oracle({all, all, all, all}, {all, all}),
            (Four{0x408f276dU, 0x41c83b0eU, 0xa20bc7c6U, 0x6d5451fdU}));
  EXPECT_EQ(philox_oracle({0x243f6a88U, 0x85a308d3U, 0x13198a2eU, 0x03707344U}, {0xa4093822U, 0x299f31d0U}),
            (Four{0xd16cfe09U, 0x94fdccebU, 0x5001e420U, 0x24126ea1U}));
}

TEST(Random, WordsAreTheKnownAnswer) {
  const Name zero{.seed = 0, .purpose = Purpose{0}, .layer = 0, .particle = 0, .attempt = 0};
  EXPECT_EQ(words(zero), (std::array<std::uint64_t, 2>{0xe169c58d6627e8d5ULL, 0x9b00dbd8bc57ac4cULL}));
}

TEST(Random, NameIsPackedAsDocumented) {
  const Name name{0x0123456789abcdefULL, Purpose::trial, 0xabcdefU, 0x123456789abcULL, 0xdeadbeefU};
  const auto block = [&](std::uint32_t b) {
    return pair_words(philox_oracle({0x56789abcU, 0x1234U | 2U << 16U | b << 24U, 0xabcdefU, 0xdeadbeefU},
                                    {0x89abcdefU, 0x01234567U}));
  };
  EXPECT_EQ(words(name), block(0));
  const auto u = uniforms(name);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(u[i], static_cast<double>(block(i < 2 ? 0 : 1)[i % 2] >> 11U) / 9007199254740992.0);
  }
}

TEST(Random, NumbersAreInRangeAndHave53Bits) {
  bool last_bit_seen[4] = {};
  for (std::uint64_t particle = 0; particle < 20000; ++particle) {
    const auto u = uniforms({7, Purpose::test, 3, particle, 0});
    for (std::size_t i = 0; i < 4; ++i) {
      ASSERT_GE(u[i], 0.0);
      ASSERT_LT(u[i], 1.0);
      const auto multiple = static_cast<std::uint64_t>(u[i] * 0x1p53);
      ASSERT_EQ(static_cast<double>(multiple) * 0x1p-53, u[i]);
      last_bit_seen[i] = last_bit_seen[i] || multiple % 2 == 1;
    }
  }
  for (const bool seen : last_bit_seen) EXPECT_TRUE(seen);
}

/// Names that differ in one part only, or that a careless packing would mix up.
std::vector<Name> sample_of_names() {
  std::vector<Name> names;
  const std::array<std::uint64_t, 5> particles{0, 1, 255, std::uint64_t{1} << 32U, (std::uint64_t{1} << 48U) - 1};
  for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{1} << 32U, ~std::uint64_t{0}}) {
    for (const Purpose purpose : {Purpose::radius, Purpose::trial, Purpose::test}) {
      for (const std::uint32_t layer : {0U, 1U, 2U, 256U, 65536U, (1U << 24U) - 1}) {
        for (const std::uint64_t particle : particles) {
          for (const std::uint32_t attempt : {0U, 1U, 2U, 65536U, ~0U}) {
            names.push_back({seed, purpose, layer, particle, attempt});
          }
        }
      }
    }
  }
  return names;
}

TEST(Random, NamesDoNotCollide) {
  std::vector<std::uint64_t> seen;
  std::vector<double> numbers;
  for (const Name& name : sample_of_names()) {
    for (const std::uint64_t word : words(name)) seen.push_back(word);
    for (const double u : uniforms(name)) numbers.push_back(u);
  }
  ASSERT_EQ(seen.size(), std::size_t{2 * 4 * 3 * 6 * 5 * 5});
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::adjacent_find(seen.begin(), seen.end()), seen.end());
  std::sort(numbers.begin(), numbers.end());
  EXPECT_EQ(std::adjacent_find(numbers.begin(), numbers.end()), numbers.end());
}

TEST(Random, SameNameSameNumbers) {
  const Name name{1, Purpose::radius, 2, 3, 4};
  EXPECT_EQ(uniforms(name), uniforms(name));
}

/// Chi-square with 99 degrees of freedom: mean 99, sd 14.1; [55, 155] is beyond 3 sd on both sides. Fixed seed.
double chi_square(const std::vector<int>& counts, double expected) {
  double sum = 0.0;
  for (const int count : counts) sum += (count - expected) * (count - expected) / expected;
  return sum;
}

TEST(Random, EachNumberIsUniformAndPairsAreIndependent) {
  constexpr int draws = 100000;
  std::array<std::vector<int>, 4> singles;
  std::array<std::vector<int>, 4> pairs;  // number i against number i + 1; the last against the next particle's first
  for (std::size_t i = 0; i < 4; ++i) singles[i].assign(100, 0), pairs[i].assign(100, 0);
  for (std::uint64_t particle = 0; particle < draws; ++particle) {
    const auto u = uniforms({42, Purpose::test, 0, particle, 0});
    const auto next = uniforms({42, Purpose::test, 0, particle + 1, 0});
    for (std::size_t i = 0; i < 4; ++i) {
      const double v = i < 3 ? u[i + 1] : next[0];
      ++singles[i][static_cast<std::size_t>(u[i] * 100.0)];
      ++pairs[i][static_cast<std::size_t>(u[i] * 10.0) * 10 + static_cast<std::size_t>(v * 10.0)];
    }
  }
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_GT(chi_square(singles[i], draws / 100.0), 55.0) << i;
    EXPECT_LT(chi_square(singles[i], draws / 100.0), 155.0) << i;
    EXPECT_GT(chi_square(pairs[i], draws / 100.0), 55.0) << i;
    EXPECT_LT(chi_square(pairs[i], draws / 100.0), 155.0) << i;
  }
}

}  // namespace
}  // namespace packmpi::random
