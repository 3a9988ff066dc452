/// A checkpoint gives back every bit on any number of ranks, is the same file from any number of them, and nothing
/// damaged is ever taken for a valid one.
#include "pack/checkpoint.hpp"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <thread>

#include "disk/text_file.hpp"
#include "pack/samples.hpp"

namespace packmpi::pack {
using namespace disk;
using namespace report;
namespace {

using testing::Folder;
using testing::Spread;

constexpr std::size_t particle_count = 137;

RunState some_state(int dimension, bool rotation, std::size_t count) {
  RunState state;
  state.serial = 41;
  state.effective_input = "seed = 18446744073709551615 # \xC2\xB5m\n";
  state.version = "0.1.0";
  state.git = "abc-dirty";
  state.dimension = dimension;
  state.rotation = rotation;
  state.progress.first_ids = {0, 100, 100};
  state.progress.count = static_cast<GlobalId>(count);
  state.progress.steps = (std::int64_t{1} << 53) + 1;  // no double
  state.progress.particle_steps = INT64_MAX;
  state.progress.layers = testing::some_record(dimension, 2).layers;
  state.progress.compaction_rate = -0.0;
  state.progress.now.phase = Phase::settling;
  state.progress.moving_from = 5;
  state.progress.height = 0.3;
  state.progress.relaxations = 1;
  state.progress.relaxation_steps = 2;
  state.progress.height_before_relaxation = 0.7;
  state.progress.now.row = state.progress.layers[1];
  state.progress.now.row.achieved_fraction = 0.1 + 0.2;
  state.progress.now.row.height = 4.9e-324;
  state.progress.now.done = 17;
  state.progress.now.phi_before = 1.0 / 3.0;
  state.progress.now.mean_height = 0.7;
  state.progress.now.calm_since = 3;
  state.progress.now.phi_calm = 0.3;
  state.progress.now.told = 5;
  state.progress.energy_given = 1e-300;
  state.progress.series = {.rows = 12, .in_file = 11, .digest = UINT64_MAX};
  return state;
}

/// Everything of a state as the checkpoint's own text has it, for comparing: each double by its bits.
std::vector<std::uint64_t> numbers_of(const RunState& state) {
  std::vector<std::uint64_t> all;
  const auto add = [&all](auto value) {
    std::uint64_t bits = 0;
    static_assert(sizeof value <= sizeof bits);
    std::memcpy(&bits, &value, sizeof value);
    all.push_back(bits);
  };
  for (const auto value : {state.serial, state.progress.count, state.progress.steps, state.progress.particle_steps,
                           state.progress.now.done, state.progress.moving_from, state.progress.relaxations,
                           state.progress.relaxation_steps, state.progress.now.calm_since, state.progress.now.told,
                           state.progress.series.rows, state.progress.series.in_file,
                           static_cast<std::int64_t>(state.progress.series.digest)})
    add(value);
  for (const double value : {state.progress.compaction_rate, state.progress.now.phi_before, state.progress.height,
                             state.progress.height_before_relaxation, state.progress.now.mean_height,
                             state.progress.now.phi_calm, state.progress.energy_given})
    add(value);
  std::vector<LayerRow> rows = state.progress.layers;
  rows.push_back(state.progress.now.row);
  for (const LayerRow& row : rows) {
    for (const auto value : {row.inserted, row.total, row.attempts, row.steps}) add(value);
    for (const double value : {row.target_fraction, row.achieved_fraction, row.region_bottom, row.height, row.top,
                               row.duration, row.kinetic_per_mgd, row.max_overlap, row.coordination}) {
      add(value);
    }
  }
  return all;
}

void expect_same(const RunState& a, const RunState& b) {
  EXPECT_EQ(numbers_of(a), numbers_of(b));
  EXPECT_EQ(a.effective_input, b.effective_input);
  EXPECT_EQ(a.version + a.git, b.version + b.git);
  EXPECT_EQ(a.progress.first_ids, b.progress.first_ids);
  EXPECT_EQ(a.progress.now.phase, b.progress.now.phase);
  EXPECT_EQ(a.progress.now.row.stop_reason, b.progress.now.row.stop_reason);
  ASSERT_EQ(a.progress.layers.size(), b.progress.layers.size());
  for (std::size_t k = 0; k < a.progress.layers.size(); ++k)
    EXPECT_EQ(a.progress.layers[k].stop_reason, b.progress.layers[k].stop_reason);
}

std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_bytes(const std::string& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

/// Contacts of some particles with earlier ones and with a wall; those without rotation do not remember.
Histories some_histories(int dimension, bool rotation, std::size_t count) {
  Histories all{.features = {.dimension = dimension, .memory = rotation, .rolling = rotation && dimension == 3},
                .rows = {}};
  const auto stored = static_cast<std::size_t>(scene::stored_doubles(all.features));
  for (GlobalId id = static_cast<GlobalId>(count) - 1; rotation && id > 0; id -= 2) {
    for (const GlobalId other : {id - 1, id / 2, GlobalId{-1 - id % 5}}) {
      if (other == id / 2 && id / 2 == id - 1) continue;
      HistoryRow row{.holder = id, .other = other};
      for (std::size_t c = 0; c < stored; ++c) row.values[c] = 1e-5 / static_cast<double>(id + 7 * other + 1000) - 1e-9;
      all.rows.push_back(row);
    }
  }
  return all;
}

bool same_rows(const std::vector<HistoryRow>& a, const std::vector<HistoryRow>& b) {
  return std::ranges::equal(a, b, [](const HistoryRow& x, const HistoryRow& y) {
    return x.holder == y.holder && x.other == y.other && x.values == y.values;
  });
}

std::vector<HistoryRow> sorted(std::vector<HistoryRow> rows) {
  std::ranges::sort(rows, [](const HistoryRow& x, const HistoryRow& y) {
    return std::pair(x.holder, x.other) < std::pair(y.holder, y.other);
  });
  return rows;
}

class Checkpoint : public ::testing::TestWithParam<std::tuple<int, bool>> {
 protected:
  comm::Comm comm_{MPI_COMM_WORLD};
  comm::Comm alone_{MPI_COMM_SELF};
  Folder folder_{comm_};
  int dimension_ = std::get<0>(GetParam());
  bool rotation_ = std::get<1>(GetParam());
  particles::Layout layout_ = particles::layout_of(dimension_, rotation_);
  std::vector<testing::Grain> grains_ = testing::some_grains(particle_count, dimension_);
  RunState state_ = some_state(dimension_, rotation_, particle_count);
  Histories histories_ = some_histories(dimension_, rotation_, particle_count);

  /// The odd ids from one store, the even ones from another.
  void write(const comm::Comm& comm, const std::string& path, const particles::Store& store,
             std::int64_t piece = rows_at_a_time) const {
    particles::Store odd(layout_), even(layout_);
    for (LocalIndex i = 0; i < store.owned(); ++i) {
      const GlobalId id = store.ids()[static_cast<std::size_t>(i)];
      (id % 2 == 0 ? even : odd).add_record(id, store.record(i));
    }
    const std::array<const particles::Store*, 2> stores{&odd, &even};
    Histories mine{.features = histories_.features, .rows = {}};  // dealt to the ranks, whoever has their particles
    for (std::size_t k = 0; k < histories_.rows.size(); ++k) {
      if (static_cast<int>(k) % comm.size() == comm.rank()) mine.rows.push_back(histories_.rows[k]);
    }
    write_checkpoint(comm, path, stores, state_, mine.here(), piece);
  }
  [[nodiscard]] std::uint64_t digest(const comm::Comm& comm, const particles::Store& store) const {
    return static_cast<std::uint64_t>(comm.sum(static_cast<std::int64_t>(particles::digest(store))));
  }
  /// Each at the rank that has its holder, by its ends.
  void expect_histories(const particles::Store& store, const Histories& found) const {
    EXPECT_EQ(found.features.memory, rotation_);
    EXPECT_EQ(found.features.rolling, rotation_ && dimension_ == 3);
    std::vector<HistoryRow> expected;
    for (const HistoryRow& row : sorted(histories_.rows)) {
      if (std::ranges::find(store.ids(), row.holder) != store.ids().end()) expected.push_back(row);
    }
    EXPECT_TRUE(same_rows(found.rows, expected));
  }
  /// What `path` is refused for; none if it is taken, and then it is what was written.
  [[nodiscard]] std::optional<std::string> refusal(const std::string& path) const {
    particles::Store store(layout_);
    Histories found;
    try {
      const RunState state = read_checkpoint(alone_, path, store, &found);
      EXPECT_TRUE(same_rows(found.rows, sorted(histories_.rows)));
      EXPECT_EQ(digest(alone_, store), digest(alone_, testing::scattered(alone_, layout_, grains_, Spread::all)));
      EXPECT_EQ(numbers_of(state), numbers_of(state_));
      EXPECT_EQ(state.effective_input, state_.effective_input);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::bad_checkpoint);
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
      return error.what();
    }
    return std::nullopt;
  }
};

TEST_P(Checkpoint, GivesBackEveryBit) {
  const std::string path = folder_.file("a.hdf");
  for (const Spread spread : testing::every_spread) {
    const particles::Store store = testing::scattered(comm_, layout_, grains_, spread);
    write(comm_, path, store);
    particles::Store back(layout_);
    Histories contacts;
    expect_same(read_checkpoint(comm_, path, back, &contacts), state_);
    EXPECT_EQ(digest(comm_, back), digest(comm_, store));
    expect_histories(back, contacts);
    EXPECT_EQ(comm_.sum(std::int64_t{back.owned()}), static_cast<std::int64_t>(particle_count));
    expect_same(read_state(path), state_);
    comm_.barrier();
  }
}

TEST_P(Checkpoint, IsTheSameFileFromAnyNumberOfRanks) {
  write(comm_, folder_.file("all.hdf"), testing::scattered(comm_, layout_, grains_, Spread::all));
  if (comm_.rank() != 0) return;
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // no second of the clock may be in it
  write(alone_, folder_.file("one.hdf"), testing::scattered(alone_, layout_, grains_, Spread::all));
  EXPECT_TRUE(bytes_of(folder_.file("all.hdf")) == bytes_of(folder_.file("one.hdf")));
}

TEST_P(Checkpoint, IsTheSameFileInPiecesOfAnySize) {
  const particles::Store store = testing::scattered(comm_, layout_, grains_, Spread::all);
  write(comm_, folder_.file("whole.hdf"), store, 100000);
  for (const std::int64_t piece : {1, 7, 50}) {  // up to sixteen pieces
    write(comm_, folder_.file("pieces.hdf"), store, piece);
    particles::Store back(layout_);
    Histories contacts;
    expect_same(read_checkpoint(comm_, folder_.file("pieces.hdf"), back, &contacts), state_);
    expect_histories(back, contacts);
    if (comm_.rank() == 0) {
      EXPECT_TRUE(bytes_of(folder_.file("pieces.hdf")) == bytes_of(folder_.file("whole.hdf"))) << piece;
    }
    comm_.barrier();
  }
}

TEST_P(Checkpoint, BeforeTheFirstLayer) {
  RunState empty;
  empty.dimension = dimension_;
  empty.rotation = rotation_;
  const std::string path = folder_.file("a.hdf");
  const particles::Store none(layout_);
  const std::array<const particles::Store*, 1> stores{&none};
  write_checkpoint(comm_, path, stores, empty);
  particles::Store back(layout_);
  EXPECT_EQ(read_checkpoint(comm_, path, back).progress.count, 0);
  EXPECT_EQ(back.owned(), 0);
}

TEST_P(Checkpoint, TruncatedAnywhereIsRefused) {
  const std::string path = folder_.file("a.hdf");
  write(comm_, path, testing::scattered(comm_, layout_, grains_, Spread::all));
  if (comm_.rank() != 0) return;
  const std::string whole = bytes_of(path);
  int refused = 0;
  for (std::size_t k = 0; k < 64; ++k) {
    write_bytes(path, whole.substr(0, whole.size() * k / 64));
    const bool right = refusal(path).has_value();
    EXPECT_TRUE(right) << "truncated to " << k << " of 64";
    refused += right ? 1 : 0;
  }
  std::printf("count: checkpoints truncated = 64, refused = %d\n", refused);
  write_bytes(path, whole.substr(0, whole.size() - 1));
  EXPECT_TRUE(refusal(path).has_value());
  write_bytes(path, whole);
  EXPECT_EQ(refusal(path), std::nullopt);
}

TEST_P(Checkpoint, AFlippedBitInAnyDatasetIsRefused) {
  const std::string path = folder_.file("a.hdf");
  write(comm_, path, testing::scattered(comm_, layout_, grains_, Spread::all));
  if (comm_.rank() != 0) return;
  const std::string whole = bytes_of(path);
  std::vector<std::string> names{
      "/state", "/effective_input", "/particles/id", "/particles/position", "/particles/radius", "/particles/velocity"};
  if (rotation_) {
    for (const char* name : {"/particles/surface_speed", "/contacts/holder", "/contacts/other"})
      names.emplace_back(name);
    for (const scene::Storing& what : scene::storings(histories_.features)) {
      names.push_back("/contacts/" + std::string(what.name));
    }
  }
  int tried = 0, refused = 0;
  for (const std::string& name : names) {
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT);
    const std::size_t begin = H5Dget_offset(dataset), size = H5Dget_storage_size(dataset);
    H5Dclose(dataset);
    H5Fclose(file);
    ASSERT_LE(begin + size, whole.size()) << name;
    for (std::size_t k = 0; k < 16; ++k) {
      std::string damaged = whole;
      const std::size_t at = begin + (size - 1) * k / 15;
      damaged[at] = static_cast<char>(damaged[at] ^ (1 << k % 8));
      write_bytes(path, damaged);
      const bool right = refusal(path).has_value();
      EXPECT_TRUE(right) << name << ", byte " << at - begin;
      ++tried;
      refused += right ? 1 : 0;
    }
    write_bytes(path, whole);
  }
  std::printf("count: bits flipped in datasets of checkpoints = %d, refused = %d\n", tried, refused);
}

// Headers, attributes and what means nothing included.
TEST_P(Checkpoint, AFlippedBitAnywhereIsRefused) {
  const std::string path = folder_.file("a.hdf");
  write(comm_, path, testing::scattered(comm_, layout_, grains_, Spread::all));
  if (comm_.rank() != 0) return;
  const std::string whole = bytes_of(path);
  int tried = 0, refused = 0;
  for (std::size_t at = 0; at < whole.size(); at += at < 4096 || at + 400 > whole.size() ? 13 : 101, ++tried) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ (1 << at % 8));
    write_bytes(path, damaged);
    const bool taken = !refusal(path);
    EXPECT_FALSE(taken) << "byte " << at << " of " << whole.size();
    refused += taken ? 0 : 1;
  }
  std::printf("count: bits flipped anywhere in checkpoints = %d, refused = %d\n", tried, refused);
}

// As the estimate tells it.
TEST_P(Checkpoint, ItsBytesAreKnownBeforehand) {
  const std::string path = folder_.file("a.hdf");
  write(comm_, path, testing::scattered(comm_, layout_, grains_, Spread::all));
  EXPECT_EQ(checkpoint_bytes(layout_, state_, histories_.features, std::ssize(histories_.rows)),
            static_cast<std::int64_t>(std::filesystem::file_size(path)));
  comm_.barrier();
}

TEST_P(Checkpoint, OtherFilesAreRefused) {
  const std::string path = folder_.file("a.hdf");
  const testing::Parts parts = testing::make_parts(comm_, layout_, grains_, Spread::all);
  write_pack(comm_, path, parts.view(false), testing::some_record(dimension_, 1));
  if (comm_.rank() != 0) return;
  EXPECT_NE(refusal(path)->find("not a checkpoint"), std::string::npos);
  write_bytes(path, "text");
  EXPECT_TRUE(refusal(path).has_value());
  EXPECT_NE(refusal(folder_.file("nowhere.hdf"))->find("no such file"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Layouts, Checkpoint, ::testing::Combine(::testing::Values(2, 3), ::testing::Bool()));

}  // namespace
}  // namespace packmpi::pack
