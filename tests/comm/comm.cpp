// The collectives against what every rank can work out alone.
#include "comm/comm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <new>
#include <numeric>
#include <stdexcept>

#include "base/memory.hpp"
#include "comm/petsc.hpp"

namespace packmpi::comm {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

TEST(Comm, SumsAndExtremesOfIntegers) {
  const Comm comm(MPI_COMM_WORLD);
  const std::int64_t n = comm.size();
  const std::int64_t big = std::int64_t{1} << 40U;
  EXPECT_EQ(comm.sum(big + comm.rank()), n * big + n * (n - 1) / 2);
  EXPECT_EQ(comm.min(big - comm.rank()), big - (n - 1));
  EXPECT_EQ(comm.max(big + comm.rank()), big + n - 1);
  EXPECT_EQ(comm.sum_below(big + comm.rank()), comm.rank() * big + comm.rank() * (comm.rank() - 1) / 2);
  std::vector<std::int64_t> values{comm.rank(), -comm.rank(), 1};
  std::vector<std::int64_t> extremes = values;
  comm.sum(std::span(values));
  comm.max(std::span(extremes));
  EXPECT_EQ(values, (std::vector<std::int64_t>{n * (n - 1) / 2, -n * (n - 1) / 2, n}));
  EXPECT_EQ(extremes, (std::vector<std::int64_t>{n - 1, 0, 1}));
  std::vector<std::int64_t> none;
  comm.sum(std::span(none));
}

TEST(Comm, ReductionsAreCountedAndNumbersGathered) {
  const Comm comm(MPI_COMM_WORLD);
  (void)comm.sum(1);
  (void)comm.max(1.0);
  (void)comm.sum_below(1);
  std::vector<double> values{1.0, 2.0};
  comm.max(std::span(values));
  agree(comm, ExitCode::done, {});
  EXPECT_EQ(comm.counters().reductions, 5);
  const std::vector<std::int64_t> mine{comm.rank(), 10 * comm.rank()};
  const std::vector<std::int64_t> all = comm.gather(mine);
  std::vector<std::int64_t> expected;
  for (std::int64_t rank = 0; rank < comm.size() && comm.rank() == 0; ++rank) {
    expected.insert(expected.end(), {rank, 10 * rank});
  }
  EXPECT_EQ(all, expected);
  EXPECT_EQ(comm.counters().reductions, 5);
}

TEST(Comm, ExtremesOfDoublesAreExact) {
  const Comm comm(MPI_COMM_WORLD);
  const bool last = comm.rank() == comm.size() - 1;
  const double denormal = std::numeric_limits<double>::denorm_min();
  for (const double x : {0.1, -0.1, denormal, -denormal, 1e300, -1e300, inf}) {
    EXPECT_EQ(comm.max(last ? x : -inf), x);
    EXPECT_EQ(comm.min(last ? -x : inf), -x);
  }
  std::vector<double> values{last ? 3.5 : -1.0, -2.0 - comm.rank()};
  comm.max(std::span(values));
  EXPECT_EQ(values, (std::vector<double>{3.5, -2.0}));
}

TEST(Comm, NanAndSignedZeroAreNotLeftToChance) {
  const Comm comm(MPI_COMM_WORLD);
  for (Rank culprit = 0; culprit < comm.size(); ++culprit) {
    const bool me = comm.rank() == culprit;
    EXPECT_TRUE(std::isnan(comm.max(me ? nan : inf)));
    EXPECT_TRUE(std::isnan(comm.min(me ? -nan : -inf)));
    EXPECT_FALSE(std::signbit(comm.max(me ? 0.0 : -0.0)));
    EXPECT_TRUE(std::signbit(comm.min(me ? -0.0 : 0.0)));
  }
}

TEST(Comm, BroadcastKeepsEveryByte) {
  const Comm comm(MPI_COMM_WORLD);
  for (Rank root = 0; root < comm.size(); ++root) {
    std::string words = "rank " + std::to_string(comm.rank());
    words += '\0';
    words.append(static_cast<std::size_t>(comm.rank()) * 1000, 'x');
    const std::string got = comm.broadcast(root, words);
    EXPECT_EQ(got.size(), 7U + static_cast<std::size_t>(root) * 1000);
    EXPECT_EQ(got.substr(0, 6), "rank " + std::to_string(root));
    EXPECT_EQ(comm.broadcast(root, ""), "");
  }
}

TEST(Comm, IsADuplicateAndMoves) {
  const Comm world(MPI_COMM_WORLD);
  Comm copy(world.handle());
  EXPECT_NE(world.handle(), copy.handle());
  const Comm moved(std::move(copy));
  EXPECT_EQ(moved.size(), world.size());
  EXPECT_EQ(moved.rank(), world.rank());
  moved.barrier();
  EXPECT_EQ(moved.sum(1), world.size());
}

TEST(Agree, AnySubsetOfComplaints) {
  const Comm comm(MPI_COMM_WORLD);
  for (unsigned subset = 0; subset < (1U << static_cast<unsigned>(comm.size())); ++subset) {
    const bool complain = (subset >> static_cast<unsigned>(comm.rank()) & 1U) != 0;
    std::optional<std::string> complaint;
    if (complain) complaint = "rank " + std::to_string(comm.rank()) + " is unhappy";
    try {
      agree(comm, ExitCode::bad_input, complaint);
      ASSERT_EQ(subset, 0U);
    } catch (const Error& error) {
      Rank lowest = 0;
      while ((subset >> static_cast<unsigned>(lowest) & 1U) == 0) ++lowest;
      ASSERT_EQ(error.what(), "rank " + std::to_string(lowest) + " is unhappy");
      ASSERT_EQ(error.code(), ExitCode::bad_input);
    }
  }
}

TEST(Agree, AnEmptyComplaintIsAComplaint) {
  const Comm comm(MPI_COMM_WORLD);
  std::optional<std::string> complaint;
  if (comm.rank() == comm.size() - 1) complaint = "";
  EXPECT_THROW(agree(comm, ExitCode::io_failure, complaint), Error);
}

/// The code and words agree_on throws when `culprit` alone throws `failure`; done and "" if it returns.
template <class Failure>
std::pair<ExitCode, std::string> agreed(const Comm& comm, Rank culprit, const Failure& failure) {
  try {
    agree_on(comm, [&] {
      if (comm.rank() == culprit) throw failure;
    });
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  return {ExitCode::done, ""};
}

TEST(AgreeOn, OneFailureIsEverybodysWithItsCode) {
  const Comm comm(MPI_COMM_WORLD);
  for (Rank culprit = 0; culprit < comm.size(); ++culprit) {
    EXPECT_EQ(agreed(comm, culprit, Error(ExitCode::stopped_early, "time is up")),
              std::pair(ExitCode::stopped_early, std::string("time is up")));
    EXPECT_EQ(agreed(comm, culprit, std::runtime_error("no such file")),
              std::pair(ExitCode::io_failure, std::string("no such file")));
  }
  EXPECT_EQ(agreed(comm, -1, Error(ExitCode::bad_input, "never")), std::pair(ExitCode::done, std::string()));
}

TEST(AgreeOn, LowestRankSpeaks) {
  const Comm comm(MPI_COMM_WORLD);
  try {
    agree_on(comm, [&] { throw Error(ExitCode{2 + comm.rank() % 5}, std::to_string(comm.rank())); });
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode{2});
    EXPECT_STREQ(error.what(), "0");
  }
}

TEST(EndTogether, WhatAllThrowIsOneError) {
  const Comm comm(MPI_COMM_WORLD);
  const Failure none = end_together(comm, [] {});
  EXPECT_EQ(none.code, ExitCode::done);
  const Failure agreed = end_together(
      comm, [&] { fail_together(comm, ExitCode::stopped_early, "all"); }, 0.0);
  EXPECT_EQ(agreed.code, ExitCode::stopped_early);
  EXPECT_EQ(agreed.words, "all");
  const Failure own = end_together(  // not agreed, but all ranks have one: the lowest is heard
      comm, [&] { throw Error(ExitCode{2 + comm.rank() % 5}, std::to_string(comm.rank())); }, 60.0);
  EXPECT_EQ(own.code, ExitCode{2});
  EXPECT_EQ(own.words, "0");
  const Failure other = end_together(
      comm, [] { throw 7; }, 60.0);
  EXPECT_EQ(other.code, ExitCode::numerical_failure);
  EXPECT_EQ(other.words, "an exception of an unknown type");
}

TEST(EndTogether, WantOfMemorySaysHowMuchOfWhat) {
  const Comm comm(MPI_COMM_WORLD);
  expect_memory(std::int64_t{3} << 30);
  const auto want = [](std::size_t bytes) {
    const Occupation now("a test");
    throw OutOfMemory(bytes);
  };
  const Failure alone = end_together(
      comm, [&] { want(5U << 20U); }, 60.0);
  EXPECT_EQ(alone.code, ExitCode::numerical_failure);
  EXPECT_TRUE(
      alone.words.starts_with("memory exhausted: 5242880 bytes (5.0 MiB) wanted by a test; this rank has held "))
      << alone.words;
  EXPECT_NE(alone.words.find(", the scene takes about 3.0 GiB of each rank; use fewer ranks a node"),
            std::string::npos);
  const Failure agreed = end_together(comm, [&] { agree_on(comm, [&] { want(1); }); });
  EXPECT_EQ(agreed.code, ExitCode::numerical_failure);
  EXPECT_TRUE(agreed.words.starts_with("memory exhausted: 1 bytes")) << agreed.words;
  expect_memory(0);
}

/// The words of the complaint about PETSc options; "" if they are taken.
std::string refusal(const std::string& options) {
  try {
    petsc_options(options);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input);
    return error.what();
  }
  return "";
}

TEST(Session, PetscTakesGoodOptionsAndNamesBadOnes) {
  for (const char* good : {"", "-implicit_snes_rtol 1e-9", "-implicit_ksp_gmres_restart 50 -implicit_pc_type jacobi",
                           "-sf_type basic", "-implicit_snes_atol -1"}) {
    EXPECT_EQ(refusal(good), "") << good;
  }
  EXPECT_NE(petsc_options_in_use().find("-implicit_pc_type jacobi"), std::string::npos) << petsc_options_in_use();
  for (const char* bad :
       {"3 4", "-prefix_push", "-options_file x", "-log_view :x", "-log_view x", "-info", "-info :x", "-dll_append x",
        "-malloc_dump", "-on_error_attach_debugger", "-implicit_snes_view binary", "-implicit_ksp_view_mat :x",
        "-implicit_pc_type python", "-implicit_pc_python_type a.b", "-implicit_snes_rtol /x", "-snes_rtol=\t1",
        "-implicit_ksp_monitor_lg_residualnorm", "-implicit_snes_monitor_solution draw", "-viewer_binary_filename x"}) {
    EXPECT_NE(refusal(bad), "") << bad;
  }
}

}  // namespace
}  // namespace packmpi::comm
