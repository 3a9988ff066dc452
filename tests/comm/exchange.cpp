// Everything sent arrives once, whole, in the round it was sent in. The patterns are drawn from a seed that all ranks
// know, so each rank can say what it must get.
#include <gtest/gtest.h>

#include <chrono>
#include <random>
#include <thread>
#include <vector>

#include "comm/comm.hpp"

namespace packmpi::comm {
namespace {

/// What rank `from` sends to rank `to` in a round: a length (-1: no parcel) and bytes that name all three.
struct Pattern {
  std::uint64_t round;
  int size;
  unsigned percent;  ///< of the pairs that exchange something
  std::uint64_t longest;

  [[nodiscard]] std::int64_t length(Rank from, Rank to) const {
    std::mt19937_64 random(round * 1000003 + static_cast<std::uint64_t>(from * size + to));
    random.discard(3);
    if (random() % 100 >= percent) return -1;
    return static_cast<std::int64_t>(random() % (longest + 1));
  }
  [[nodiscard]] Parcel parcel(Rank from, Rank to, Rank label) const {
    Parcel made{label, std::vector<std::byte>(static_cast<std::size_t>(length(from, to)))};
    for (std::size_t k = 0; k < made.bytes.size(); ++k) {
      made.bytes[k] = static_cast<std::byte>(k + 31 * round + 7 * static_cast<std::size_t>(from) +
                                             101 * static_cast<std::size_t>(to));
    }
    return made;
  }
};

std::vector<Parcel> outgoing(const Comm& comm, const Pattern& pattern) {
  std::vector<Parcel> parcels;
  for (Rank to = comm.size() - 1; to >= 0; --to) {  // in no order that helps
    if (pattern.length(comm.rank(), to) >= 0) parcels.push_back(pattern.parcel(comm.rank(), to, to));
  }
  return parcels;
}

void check(const Comm& comm, const Pattern& pattern, const std::vector<Parcel>& incoming) {
  std::vector<Parcel> expected;
  for (Rank from = 0; from < comm.size(); ++from) {
    if (pattern.length(from, comm.rank()) >= 0) expected.push_back(pattern.parcel(from, comm.rank(), from));
  }
  ASSERT_EQ(incoming.size(), expected.size()) << "round " << pattern.round;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    ASSERT_EQ(incoming[k].rank, expected[k].rank) << "round " << pattern.round;
    ASSERT_EQ(incoming[k].bytes, expected[k].bytes) << "round " << pattern.round;
  }
}

void play(const Comm& comm, const Pattern& pattern, int longest_message = 1 << 30) {
  check(comm, pattern, exchange(comm, outgoing(comm, pattern), Purpose::other, longest_message));
}

/// On any rank: all end a test together, as one that left alone would be waited for.
bool has_failed(const Comm& comm) { return comm.max(std::int64_t{::testing::Test::HasFatalFailure()}) != 0; }

/// Through ranks between, on any number of ranks.
void play_relayed(const Comm& comm, const Pattern& pattern) {
  check(comm, pattern, relay(comm, outgoing(comm, pattern), Purpose::other, 1));
}

TEST(Relay, BringsWhatAnExchangeBrings) {
  const Comm comm(MPI_COMM_WORLD);
  for (std::uint64_t round = 0; round < 100; ++round) {
    play_relayed(comm, {round, comm.size(), static_cast<unsigned>(round * 37 % 101), round % 10 == 0 ? 20000U : 64U});
    if (has_failed(comm)) return;
  }
  play_relayed(comm, {1, comm.size(), 100, 0});
  play_relayed(comm, {2, comm.size(), 0, 0});
}

TEST(Relay, SendsAtMostTwoRowsOfMessages) {
  const Comm comm(MPI_COMM_WORLD);
  int width = 1;
  while (width * width < comm.size()) ++width;
  const auto sent = [&](Purpose purpose) { return comm.counters().sent[static_cast<std::size_t>(purpose)]; };
  (void)relay(comm, outgoing(comm, {1, comm.size(), 100, 50}), Purpose::output, 1);
  EXPECT_LE(sent(Purpose::output).messages, 2 * (width - 1));
  const std::int64_t all = comm.sum(sent(Purpose::output).messages);
  EXPECT_GE(all, comm.size() - 1);
  (void)relay(comm, outgoing(comm, {1, comm.size(), 100, 50}), Purpose::insertion, comm.size() + 1);
  EXPECT_EQ(sent(Purpose::insertion).messages, comm.size() - 1);
}

TEST(Exchange, NobodySends) {
  const Comm comm(MPI_COMM_WORLD);
  for (std::uint64_t round = 0; round < 20; ++round) play(comm, {round, comm.size(), 0, 0});
}

TEST(Exchange, AllToAllAndToOneself) {
  const Comm comm(MPI_COMM_WORLD);
  for (std::uint64_t round = 0; round < 20; ++round) play(comm, {round, comm.size(), 100, 5000});
  const std::vector<Parcel> own = exchange(comm, {{comm.rank(), {std::byte{42}}}});
  ASSERT_EQ(own.size(), 1U);
  EXPECT_EQ(own[0].rank, comm.rank());
  EXPECT_EQ(own[0].bytes, std::vector<std::byte>{std::byte{42}});
}

TEST(Exchange, EmptyParcelsArrive) {
  const Comm comm(MPI_COMM_WORLD);
  play(comm, {1, comm.size(), 100, 0});
}

TEST(Exchange, TwoHundredRandomRoundsWithoutAPause) {
  const Comm comm(MPI_COMM_WORLD);
  for (std::uint64_t round = 0; round < 200; ++round) {
    play(comm, {round, comm.size(), static_cast<unsigned>(round * 37 % 101), round % 10 == 0 ? 20000U : 64U});
    if (has_failed(comm)) return;
  }
}

TEST(Exchange, LateRanksDoNotMixRounds) {
  const Comm comm(MPI_COMM_WORLD);
  std::mt19937_64 random(static_cast<std::uint64_t>(comm.rank()));
  for (std::uint64_t round = 0; round < 40; ++round) {
    if (random() % 4 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(random() % 5));
    play(comm, {round, comm.size(), 60, 16});
    if (has_failed(comm)) return;
  }
}

TEST(Exchange, LargeParcels) {
  const Comm comm(MPI_COMM_WORLD);
  play(comm, {3, comm.size(), 100, 3000000});
}

TEST(Exchange, ParcelsLongerThanAMessage) {  // as those of more than 2 GiB are
  const Comm comm(MPI_COMM_WORLD);
  for (std::uint64_t round = 0; round < 50; ++round) {
    play(comm, {round, comm.size(), 80, 40}, 1 + static_cast<int>(round % 9));
  }
}

TEST(Exchange, CountsWhatLeavesTheRank) {
  const Comm comm(MPI_COMM_WORLD);
  const auto sent = [&](Purpose purpose) { return comm.counters().sent[static_cast<std::size_t>(purpose)]; };
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
  for (std::uint64_t round = 0; round < 10; ++round) {
    std::vector<Parcel> parcels = outgoing(comm, {round, comm.size(), 60, 300});
    for (const Parcel& parcel : parcels) {
      if (parcel.rank == comm.rank()) continue;
      ++messages;
      bytes += std::ssize(parcel.bytes);
    }
    (void)exchange(comm, std::move(parcels), Purpose::migration);
  }
  EXPECT_EQ(sent(Purpose::migration).messages, messages);
  EXPECT_EQ(sent(Purpose::migration).bytes, bytes);
  EXPECT_EQ(sent(Purpose::other).messages, 0);
  EXPECT_EQ(comm.counters().exchanges, 10);
  EXPECT_EQ(comm.counters().reductions, 0);
  comm.count(Purpose::ghosts, {2, 100});
  comm.count(Purpose::ghosts, {1, 11});
  EXPECT_EQ(sent(Purpose::ghosts).messages, 3);
  EXPECT_EQ(sent(Purpose::ghosts).bytes, 111);
}

TEST(Exchange, MixesWithOtherCollectivesAndCommunicators) {
  const Comm comm(MPI_COMM_WORLD);
  const Comm other(comm.handle());
  for (std::uint64_t round = 0; round < 30; ++round) {
    play(comm, {round, comm.size(), 50, 100});
    ASSERT_EQ(comm.sum(1), comm.size());
    play(other, {round + 1000, comm.size(), 50, 100});
  }
}

}  // namespace
}  // namespace packmpi::comm
