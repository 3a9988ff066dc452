/// Every call of the system that writes or reads a checkpoint or a pack fails once, one after the other, on all ranks
/// and on one alone: nothing valid is lost, nothing wrong is taken, every rank hears of it, nobody waits for ever.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <sstream>

#include "disk/text_file.hpp"
#include "pack/checkpoint.hpp"
#include "pack/samples.hpp"
#include "report/step_log.hpp"
#include "support/io_faults.hpp"

namespace packmpi::pack {
using namespace disk;
using namespace report;
namespace {

using testing::Fault;
using testing::Folder;
using testing::Spread;

constexpr std::size_t particle_count = 4000;
constexpr std::array write_faults{Fault::no_space, Fault::disk_full, Fault::io_error, Fault::short_write};
constexpr std::array names{"", "ENOSPC", "ENOSPC from then on", "EIO", "short write", "EIO in reading"};

/// In memory if possible: thousands of fsyncs of a disk take a minute.
std::filesystem::path fast_folder() {
  const std::filesystem::path memory = "/dev/shm";
  return std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
}

class Faults : public ::testing::Test {
 protected:
  comm::Comm comm_{MPI_COMM_WORLD};
  Folder folder_{comm_, fast_folder()};
  std::string prefix_ = folder_.path();
  std::string path_ = folder_.file("a.hdf");
  testing::Parts parts_ =
      testing::make_parts(comm_, particles::layout_of(3, true), testing::some_grains(particle_count, 3), Spread::all);
  std::uint64_t digest_ = digest_of(comm_, parts_.store);

  [[nodiscard]] static std::uint64_t digest_of(const comm::Comm& comm, const particles::Store& store) {
    return static_cast<std::uint64_t>(comm.sum(static_cast<std::int64_t>(particles::digest(store))));
  }

  /// The code `action` ends with, which must be the same on every rank, while the `call`-th call fails on this rank if
  /// it is `who` (-1: on every rank). None if no call failed anywhere.
  std::optional<ExitCode> attempt(const std::function<void()>& action, Fault fault, int who, long call) {
    io_faults_arm(prefix_.c_str(), fault, who < 0 || who == comm_.rank() ? call : 0);
    ExitCode code = ExitCode::done;
    std::string words;
    try {
      action();
    } catch (const Error& error) {
      code = error.code();
      words = error.what();
    }
    const long failed = io_faults_disarm();
    const auto number = static_cast<std::int64_t>(code);
    EXPECT_EQ(comm_.max(number), comm_.min(number)) << words;
    EXPECT_EQ(words, comm_.broadcast(0, words));
    if (comm_.sum(std::int64_t{failed}) == 0) {
      EXPECT_EQ(code, ExitCode::done) << words;
      return std::nullopt;
    }
    return code;
  }

  /// For every fault of `faults`, on all ranks and on each alone, every call in turn. `after` looks at what is left.
  void try_all(const char* what, std::span<const Fault> faults, const std::function<void()>& action,
               const std::function<void(ExitCode)>& after) {
    for (const Fault fault : faults) {
      long trials = 0, told = 0;
      for (int who = comm_.size() == 1 ? 0 : -1; who < comm_.size(); ++who) {
        for (long call = 1; call < 1000; ++call) {
          SCOPED_TRACE(
              fmt::format("{}, {}, rank {}, call {}", what, names.at(static_cast<std::size_t>(fault)), who, call));
          const auto code = attempt(action, fault, who, call);
          comm_.barrier();
          after(code.value_or(ExitCode::done));
          comm_.barrier();
          if (!code) break;
          ++trials;
          told += *code == ExitCode::done ? 0 : 1;
        }
      }
      EXPECT_GT(trials, 0) << what;  // the layer is there, and counts
      if (comm_.rank() == 0) {
        fmt::print("count: {}, {}, {} ranks: calls failed = {}, told = {}\n", what,
                   names.at(static_cast<std::size_t>(fault)), comm_.size(), trials, told);
      }
    }
  }

  /// Versions 0 and 1 of a file are written over each other by `write`; what is there after a fault is one of them,
  /// byte for byte, and nothing else is.
  void write_and_look(const char* what, const std::function<void(int, const std::string&)>& write) {
    std::array<std::string, 2> versions;
    for (const int version : {1, 0}) {
      write(version, path_);
      versions.at(static_cast<std::size_t>(version)) = bytes_of(path_);
      comm_.barrier();
    }
    int valid = 0;
    try_all(
        what, write_faults, [&] { write(1 - valid, path_); },
        [&](ExitCode code) {
          EXPECT_TRUE(code == ExitCode::done || code == ExitCode::io_failure);
          EXPECT_EQ(files(), std::vector<std::string>{"a.hdf"});
          const std::string there = bytes_of(path_);
          const bool is_new = there == versions.at(static_cast<std::size_t>(1 - valid));
          const bool is_old = there == versions.at(static_cast<std::size_t>(valid));
          EXPECT_TRUE(is_new || (is_old && code != ExitCode::done)) << is_old;
          if (is_new) valid = 1 - valid;
        });
  }

  [[nodiscard]] std::vector<std::string> files() const {
    std::vector<std::string> all;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      all.push_back(entry.path().filename());
    std::ranges::sort(all);
    return all;
  }

  [[nodiscard]] static std::string bytes_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

// Two checkpoints (packs) in turn: the one that is there is whole, and it is the new one unless an error was told. With
// an error it may be the new one all the same: the fsync of the folder comes last.
TEST_F(Faults, WritingACheckpoint) {
  RunState state;
  state.progress.count = static_cast<GlobalId>(particle_count);
  state.effective_input = "seed = 1\n";
  const std::array<const particles::Store*, 1> stores{&parts_.store};
  write_and_look("checkpoint", [&](int version, const std::string& path) {
    state.serial = version;
    write_checkpoint(comm_, path, stores, state);
  });
}

TEST_F(Faults, ReadingACheckpoint) {
  RunState state;
  state.progress.count = static_cast<GlobalId>(particle_count);
  state.serial = 7;
  const std::array<const particles::Store*, 1> stores{&parts_.store};
  write_checkpoint(comm_, path_, stores, state);
  particles::Store back(parts_.store.layout());
  RunState got;
  constexpr std::array faults{Fault::read_error};
  try_all(
      "checkpoint", faults,
      [&] {
        back = particles::Store(parts_.store.layout());
        got = read_checkpoint(comm_, path_, back);
      },
      [&](ExitCode code) {
        EXPECT_TRUE(code == ExitCode::done || code == ExitCode::bad_checkpoint);
        const std::uint64_t digest = digest_of(comm_, back);
        if (code != ExitCode::done) return;
        EXPECT_EQ(digest, digest_);
        EXPECT_EQ(got.serial, 7);
      });
}

TEST_F(Faults, WritingAPack) {
  write_and_look("pack", [&](int version, const std::string& path) {
    parts_.layer.assign(parts_.layer.size(), version);
    write_pack(comm_, path, parts_.view(true), testing::some_record(3, 2));
  });
}

TEST_F(Faults, WritingASummary) {
  write_and_look("summary", [&](int version, const std::string& path) {
    write_text(comm_, path, fmt::format("{:0100}\n", version));
  });
}

/// What this rank did to the files of its folder while `action` ran, a line a call.
std::vector<std::string> record_of(const std::string& prefix, const std::function<void()>& action) {
  io_faults_record(prefix.c_str());
  action();
  std::istringstream lines(io_faults_recorded());
  std::vector<std::string> calls;
  for (std::string line; std::getline(lines, line);) calls.push_back(line);
  return calls;
}

// What a power cut cannot undo: each rank has its bytes on the disk before the name is given, and the name after it.
TEST_F(Faults, EveryByteIsOnTheDiskBeforeTheNameIsGiven) {
  RunState state;
  state.progress.count = static_cast<GlobalId>(particle_count);
  const std::array<const particles::Store*, 1> stores{&parts_.store};
  const std::array<std::function<void()>, 3> writers{
      [&] { write_checkpoint(comm_, path_, stores, state); },
      [&] { write_pack(comm_, path_, parts_.view(true), testing::some_record(3, 2)); },
      [&] { write_text(comm_, path_, "words\n"); }};
  for (const auto& write : writers) {
    const std::vector<std::string> calls = record_of(prefix_, write);
    const auto last = [&calls](const std::string& call) {  // 0: never
      return calls.rend() - std::find(calls.rbegin(), calls.rend(), call);
    };
    const std::string all = fmt::format("{}", fmt::join(calls, ", "));
    const auto written = last("write a.hdf.tmp");
    EXPECT_EQ(last("write a.hdf"), 0) << all;
    EXPECT_GE(last("fsync a.hdf.tmp"), written) << all;
    if (&write != &writers.back()) {
      EXPECT_GT(written, 0) << all;
    }
    if (comm_.rank() != 0) continue;
    EXPECT_GT(last("fsync a.hdf.tmp"), written) << all;
    EXPECT_GT(last("rename a.hdf"), last("fsync a.hdf.tmp")) << all;
    EXPECT_GT(last("fsync ."), last("rename a.hdf")) << all;
  }
}

// A time series is written in place: after a fault that passes it is whole, and rows that are missing are told.
TEST_F(Faults, WritingATimeSeries) {
  std::int64_t told = 0;
  const auto write = [&] {
    SeriesMark mark;
    StepLog log(comm_, path_, mark, false);
    for (int k = 0; k < 5; ++k) log.append({.step = k});
    log.sync();
    told = log.close();
  };
  try_all("time series", write_faults, write, [&](ExitCode code) {
    EXPECT_TRUE(code == ExitCode::done || code == ExitCode::io_failure);
    const std::string text = bytes_of(path_);
    const auto whole = std::ranges::count(text, '\n');  // with the header
    EXPECT_TRUE(code != ExitCode::done || whole >= told + 1) << whole << " lines, told: " << told;
    EXPECT_LE(told, 5);
  });
}

}  // namespace
}  // namespace packmpi::pack
