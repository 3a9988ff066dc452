// A run that is stopped anywhere and goes on, on other ranks and in another decomposition, ends with the bits of one
// that was never touched: the particles, the summary, the time series.
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "base/signals.hpp"
#include "pack/checkpoint.hpp"
#include "pack/pack.hpp"
#include "pack/scene_change.hpp"
#include "run/make_pack.hpp"
#include "support/scenes.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;
using input::Decomposition;

struct Kind {
  const char* name;
  int dimension;
  bool graded, periodic, near_field, rotation;
  int window;
  bool soft_and_settled;                 // layers end when at rest, softer than the final stage, which hardens them
  bool memory = false, rolling = false;  // of contacts
  bool clipped = false;                  // the third layer ends at H_d
  bool round = false;                    // in a cylinder
};

constexpr std::array kinds{Kind{"spheres", 3, false, false, false, true, 0, false},
                           Kind{"graded_discs", 2, true, true, false, true, 0, false},
                           Kind{"near_field", 3, true, false, true, false, 0, false},
                           Kind{"discs_without_spin", 2, false, false, false, false, 0, false},
                           Kind{"window", 3, false, true, false, true, 1, false},
                           Kind{"settled", 3, false, false, false, true, 2, true},
                           Kind{"clipped", 3, true, false, false, true, 0, false, false, false, true},
                           Kind{"clipped_discs", 2, false, true, false, true, 0, false, false, false, true},
                           Kind{"memory", 3, false, false, false, true, 0, false, true},
                           Kind{"memory_without_spin", 2, true, false, false, false, 0, false, true},
                           Kind{"rolling_discs", 2, false, true, false, true, 1, false, true, true},
                           Kind{"rolling_spheres", 3, true, true, false, true, 1, false, true, true},
                           Kind{"cylinder", 3, true, false, false, true, 1, false, true, true, false, true}};

constexpr std::int64_t layer_steps = 100;

input::Input scene_of(const Kind& kind) {
  const double r = 0.02;
  input::Input in = kind.graded ? test::graded_input(kind.dimension, 0.6, 0.6 * r, 1.0 / 0.6)
                                : test::small_input(kind.dimension, 0.6, r);
  if (kind.dimension == 3) in.container.size = {0.4, 0.2, 0.4};
  if (kind.dimension == 2) in.container.size = {0.6, 0.5};
  if (kind.clipped) {
    in.container.size.back() = 0.22;
    in.layers.region = input::RegionRule::container;
  }
  if (kind.periodic) in = test::periodic(in);
  if (kind.round) {
    in.container.shape = input::VesselShape::cylinder;
    in.container.diameter = in.container.height = 0.4;
    in.container.size = {0.4, 0.4, 0.4};
  }
  if (kind.near_field) in.near_field = input::NearField{1e-4, 2.0, 1e-6, 3.5, 0.06};
  in.name = "restart";
  in.effective = "seed = 1\n[layers]\nfraction = 0.2\n[output]\ncontacts = false\n";
  in.layers.thickness = 0.1;
  in.layers.fraction = kind.dimension == 3 ? 0.2 : 0.3;
  in.layers.duration = static_cast<double>(layer_steps) * 1e-4;
  in.layers.maximum = 3;
  in.layers.velocity = kind.dimension == 3 ? Vec3{0.3, 0.2, -2.0} : Vec3{0.3, -2.0, 0.0};
  in.jamming.gravity = 10.0;
  in.dynamics.time_step = 1e-4;
  in.dynamics.rotation = kind.rotation;
  in.dynamics.window = kind.window;
  if (kind.window > 0) in.dynamics.relaxation = 0.01;
  if (kind.window == 1) {  // the final stage waits for rest, in vain
    in.rest.kinetic_energy = 1e-30;
    in.rest.wait = 0.01;
  }
  if (kind.soft_and_settled) {
    in.layers.youngs_modulus = 0.1 * in.particles.youngs_modulus;
    in.layers.time_step = 1e-4;
    in.dynamics.stop = input::StopRule::settled;
    in.dynamics.settled_energy = 1e9;  // from the first look on: a hold later the layer is over
    in.dynamics.settled_drift = 50.0;  // ten times what there is; a mean height that is forgotten is beyond it
    in.dynamics.settled_hold = 0.0061;
    in.dynamics.settled_force = 10.0;
  }
  if (kind.memory) {  // what a contact holds comes from many before: dense, and all the time in contact
    in.contact.tangential = input::Tangential::mindlin;
    in.layers.velocity[kind.dimension == 3 ? 2U : 1U] = -8.0;
    in.jamming.gravity = 100.0;
  }
  if (kind.rolling) {
    in.contact.rolling_friction = 0.1;
    in.contact.twisting_friction = kind.dimension == 3 ? 0.1 : 0.0;
  }
  in.output.log_every = 0.0007;
  in.checkpoint.every = "off";
  return in;
}

/// Restarts, and packs compared after them, for scripts/dev/faults.sh.
struct Counts : ::testing::Environment {
  int restarts = 0, compared = 0, same = 0;
  void TearDown() override {
    const comm::Comm world(MPI_COMM_WORLD);
    if (world.rank() != 0) return;
    std::printf("count: restarts on up to %d ranks = %d\n", world.size(), restarts);
    std::printf("count: packs of them compared with that of an untouched run = %d, bit-equal = %d\n", compared, same);
  }
};
Counts& counts() {
  static auto* const all = dynamic_cast<Counts*>(::testing::AddGlobalTestEnvironment(new Counts));
  return *all;
}
[[maybe_unused]] const Counts& counts_from_the_start = counts();

/// What a run left.
struct Left {
  pack::PackRows rows;
  report::RunRecord record;
  std::string series;  // NAME.steps.csv without the column of rebuilds
};

class Restart : public ::testing::TestWithParam<Kind> {
 protected:
  comm::Comm world_{MPI_COMM_WORLD};
  std::string folder_ =
      world_.broadcast(0, (fs::temp_directory_path() / ("packmpi_restart_" + std::to_string(::getpid()))).string());
  input::Input in_ = scene_of(GetParam());

  void SetUp() override {
    if (world_.size() > 3 && !GetParam().memory) GTEST_SKIP() << "more ranks are for contacts that remember";
  }
  void TearDown() override {
    world_.barrier();
    if (world_.rank() == 0) fs::remove_all(folder_);
    world_.barrier();
  }

  [[nodiscard]] std::string file(const std::string& end) const { return folder_ + "/restart." + end; }

  /// Runs on the first `ranks` ranks; the exit code, the same on all ranks of the world. Others wait.
  ExitCode run(int ranks, Decomposition kind, const std::function<void(Options&)>& change) {
    return run(in_, ranks, kind, change);
  }
  ExitCode run(input::Input in, int ranks, Decomposition kind, const std::function<void(Options&)>& change) {
    in.parallel.decomposition = kind;
    Options options;
    options.folder = folder_;
    options.verbosity = log::Verbosity::quiet;
    change(options);
    if (!options.restart.empty()) ++counts().restarts;
    MPI_Comm part = MPI_COMM_NULL;
    MPI_Comm_split(MPI_COMM_WORLD, world_.rank() < ranks ? 0 : 1, world_.rank(), &part);
    ExitCode code = ExitCode::done;
    if (world_.rank() < ranks) {
      const comm::Comm comm(part);
      const Signals signals;
      try {
        left_.record = make_pack(comm, scene::build(in), options);
      } catch (const Error& error) {
        code = error.code();
        words_ = error.what();
      }
    }
    MPI_Comm_free(&part);
    words_ = world_.broadcast(0, words_);
    return static_cast<ExitCode>(world_.max(static_cast<std::int64_t>(code)));
  }

  [[nodiscard]] Left left() {
    Left now = left_;
    now.rows = pack::read_pack(file("hdf"));
    std::ifstream series(file("steps.csv"));
    for (std::string line; std::getline(series, line);) {
      std::istringstream cells(line);
      std::string cell;
      for (int column = 0; std::getline(cells, cell, ','); ++column) {
        if (column != 9) now.series += cell + ',';
      }
      now.series += '\n';
    }
    world_.barrier();
    return now;
  }

  void expect_same(const Left& a, const Left& b) const {
    compare(a, b);
    ++counts().compared;
    if (!HasFailure()) ++counts().same;
  }

  void compare(const Left& a, const Left& b) const {
    EXPECT_EQ(a.rows.id, b.rows.id);
    EXPECT_EQ(a.rows.position, b.rows.position);
    EXPECT_EQ(a.rows.velocity, b.rows.velocity);
    EXPECT_EQ(a.rows.spin, b.rows.spin);
    EXPECT_EQ(a.rows.radius, b.rows.radius);
    EXPECT_EQ(a.rows.layer, b.rows.layer);
    EXPECT_EQ(a.rows.contacts, b.rows.contacts);
    EXPECT_EQ(a.series, b.series);
    if (world_.rank() != 0) return;  // the others may not have run
    const report::RunRecord &x = a.record, &y = b.record;
    const auto numbers = [](const report::RunRecord& r) {
      return std::array{r.height,
                        r.top,
                        r.phi,
                        r.phi_bulk,
                        r.compaction_rate,
                        r.rest.unbalanced_force,
                        r.rest.kinetic_energy,
                        r.rest.support,
                        r.rest.mean_overlap,
                        r.rest.worst_overlap,
                        r.rest.network.coordination,
                        r.rest.network.rattlers,
                        r.kinetic_energy,
                        r.floor_force,
                        r.weight,
                        r.mean_radius,
                        r.height_before_relaxation};
    };
    EXPECT_EQ(numbers(x), numbers(y));
    EXPECT_EQ(x.steps, y.steps);
    EXPECT_EQ(x.particle_steps, y.particle_steps);
    EXPECT_EQ(x.relaxations, y.relaxations);
    EXPECT_EQ(x.relaxation_steps, y.relaxation_steps);
    ASSERT_EQ(x.layers.size(), y.layers.size());
    for (std::size_t k = 0; k < x.layers.size(); ++k) {
      EXPECT_EQ(x.layers[k].height, y.layers[k].height);
      EXPECT_EQ(x.layers[k].attempts, y.layers[k].attempts);
      EXPECT_EQ(x.layers[k].kinetic_per_mgd, y.layers[k].kinetic_per_mgd);
      EXPECT_EQ(x.layers[k].steps, y.layers[k].steps);
      EXPECT_EQ(x.layers[k].stop_reason, y.layers[k].stop_reason);
    }
  }

  [[nodiscard]] Left untouched() {
    EXPECT_EQ(run(world_.size(), Decomposition::slab, [](Options&) {}), ExitCode::done) << words_;
    const Left whole = left();
    EXPECT_FALSE(fs::exists(file("ckpt.A.hdf")));
    return whole;
  }

  /// Its contacts remember if those of the scene do: in the middle of many of them.
  void expect_contacts(std::int64_t step) const {
    if (world_.rank() == 0) {
      const Kind& kind = GetParam();
      particles::Store store(particles::layout_of(kind.dimension, kind.rotation));
      pack::Histories found;
      (void)pack::read_checkpoint(comm::Comm(MPI_COMM_SELF), file("ckpt.A.hdf"), store, &found);
      EXPECT_EQ(found.features.memory, kind.memory);
      EXPECT_EQ(found.features.rolling, kind.rolling);
      const std::size_t least = kind.memory && step >= 2 * layer_steps ? 5 : 0;
      EXPECT_GE(found.rows.size(), least);
    }
    world_.barrier();
  }

  Left left_;
  std::string words_;
};

// After a few steps, in mid-layer, at a layer's end, near the end of the second, in the third, in the final stage if
// there is one.
TEST_P(Restart, StoppedAnywhereOnOtherRanks) {
  const Left whole = untouched();
  const std::array kinds_of{Decomposition::slab, Decomposition::pencil, Decomposition::metis};
  std::size_t turn = 0;
  for (const std::int64_t stop :
       {std::int64_t{1}, layer_steps / 2, layer_steps, layer_steps + 93, 2 * layer_steps + 7, 3 * layer_steps - 1}) {
    for (const int ranks : {world_.size(), 1}) {
      SCOPED_TRACE(::testing::Message() << "stopped after " << stop << " steps, goes on on " << ranks << " ranks");
      const int before = world_.size() + 1 - ranks;
      EXPECT_EQ(run(before, kinds_of[turn++ % 3], [&](Options& o) { o.force = true, o.max_steps = stop; }),
                ExitCode::stopped_early)
          << words_;
      expect_contacts(stop);
      EXPECT_EQ(run(ranks, kinds_of[turn % 3], [](Options& o) { o.restart = "auto"; }), ExitCode::done) << words_;
      expect_same(left(), whole);
      EXPECT_FALSE(fs::exists(file("ckpt.A.hdf")) || fs::exists(file("ckpt.B.hdf")) || fs::exists(file("ckpt.json")));
      world_.barrier();
    }
  }
}

// Again and again, from one checkpoint to the next.
TEST_P(Restart, ManyTimes) {
  const Left whole = untouched();
  ExitCode code = run(world_.size(), Decomposition::slab, [](Options& o) { o.force = true, o.max_steps = 37; });
  int times = 0;
  for (; code == ExitCode::stopped_early && times < 100; ++times) {
    code =
        run(1 + times % world_.size(), Decomposition::slab, [](Options& o) { o.restart = "auto", o.max_steps = 37; });
  }
  EXPECT_EQ(code, ExitCode::done) << words_;
  EXPECT_GT(times, 5);
  expect_same(left(), whole);
}

// As after a kill: the newest checkpoint is gone or damaged, steps were made and told after the one before it.
TEST_P(Restart, FromTheOtherSlot) {
  const Left whole = untouched();
  for (const bool damaged : {false, true}) {
    in_.checkpoint.every = "60 steps";
    EXPECT_EQ(
        run(world_.size(), Decomposition::slab, [](Options& o) { o.force = true, o.max_steps = 2 * layer_steps - 5; }),
        ExitCode::stopped_early);
    // 60, 100 (layer), 160 and 195 (stop) were written in turn: B is the newest
    if (world_.rank() == 0) {
      if (damaged) {
        fs::resize_file(file("ckpt.B.hdf"), fs::file_size(file("ckpt.B.hdf")) / 2);
      } else {
        fs::remove(file("ckpt.B.hdf"));
      }
    }
    world_.barrier();
    EXPECT_EQ(run(1, Decomposition::slab, [](Options& o) { o.restart = "auto"; }), ExitCode::done) << words_;
    expect_same(left(), whole);
  }
}

TEST_P(Restart, FromALayersEnd) {
  const Left whole = untouched();
  in_.checkpoint.every = "100000 steps";  // so only layers' ends
  EXPECT_EQ(run(1, Decomposition::slab, [](Options& o) { o.force = true, o.max_steps = layer_steps + 10; }),
            ExitCode::stopped_early);
  if (world_.rank() == 0) fs::remove(file("ckpt.B.hdf"));
  world_.barrier();
  EXPECT_EQ(run(world_.size(), Decomposition::slab, [&](Options& o) { o.restart = file("ckpt.A.hdf"); }),
            ExitCode::done)
      << words_;
  expect_same(left(), whole);
}

// Killed when all is done but the writing of the pack: what is reported is what the checkpoint has.
TEST_P(Restart, FromTheVeryEnd) {
  const Left whole = untouched();
  in_.checkpoint.every = "100000 steps";  // at layers' ends
  if (world_.rank() == 0) {
    fs::remove(file("hdf"));
    fs::create_directories(file("hdf") + "/in_the_way");
  }
  world_.barrier();
  EXPECT_EQ(run(world_.size(), Decomposition::slab, [](Options& o) { o.force = true; }), ExitCode::io_failure);
  if (world_.rank() == 0) fs::remove_all(file("hdf"));
  world_.barrier();
  EXPECT_EQ(run(1, Decomposition::slab, [](Options& o) { o.restart = "auto"; }), ExitCode::done) << words_;
  EXPECT_EQ(world_.rank() == 0 ? left_.record.steps_here : 0, 0);
  expect_same(left(), whole);
}

std::string kind_name(const ::testing::TestParamInfo<Kind>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Scenes, Restart, ::testing::ValuesIn(kinds), kind_name);

class RestartRules : public Restart {};
INSTANTIATE_TEST_SUITE_P(OneScene, RestartRules, ::testing::Values(kinds[0]), kind_name);

// A layer that comes to rest by energy and drift, whose looks must go on as if nothing had been: stopped while the time
// at rest is counted, and at its very end, when nothing will measure the compaction rate again.
TEST_P(RestartRules, StoppedWhileItComesToRest) {
  in_.layers.maximum = 1;
  in_.layers.duration = 0.8;
  in_.layers.velocity = {};
  in_.container.size = {0.4, 0.2, 0.06};  // a layer reaches into the bulk
  in_.dynamics.stop = input::StopRule::settled;
  in_.dynamics.settled_energy = 0.05;
  in_.dynamics.settled_drift = 0.02;
  in_.dynamics.settled_hold = 0.03;
  in_.dynamics.settled_force = 1e9;
  const Left whole = untouched();
  const std::int64_t end = whole.record.layers.at(0).steps;  // all ranks made it
  for (const std::int64_t stop : {end - 147, end}) {
    SCOPED_TRACE(::testing::Message() << "stopped after " << stop << " of " << end << " steps");
    EXPECT_EQ(run(1, Decomposition::slab, [&](Options& o) { o.force = true, o.max_steps = stop; }),
              ExitCode::stopped_early);
    const pack::RunState state = pack::read_state(file("ckpt.A.hdf"));
    world_.barrier();
    EXPECT_TRUE(stop == end ? state.progress.now.phase == pack::Phase::relaxation : state.progress.now.calm_since > 0)
        << state.progress.now.calm_since;
    EXPECT_EQ(run(world_.size(), Decomposition::slab, [](Options& o) { o.restart = "auto"; }), ExitCode::done)
        << words_;
    expect_same(left(), whole);
    if (world_.rank() == 0) {
      EXPECT_EQ(whole.record.layers[0].stop_reason, "settled");
      EXPECT_NE(left_.record.compaction_rate, 0.0);
    }
  }
}

// A bed that is stopped at each peak of its energy: right after a look at it, and between two.
TEST_P(RestartRules, StoppedWhileItsSwingIsDamped) {
  in_.layers.maximum = 1;
  in_.layers.duration = 0.8;
  in_.layers.velocity = {};
  in_.container.size = {0.4, 0.2, 0.3};  // an energy is looked at each few steps
  in_.rest.unbalanced_force = 1e9;
  in_.rest.kinetic_energy = 1e-30;
  in_.rest.support = 1e-9;
  in_.rest.wait = 0.2;
  const Left whole = untouched();
  const std::int64_t settled = whole.record.layers.at(0).steps, end = settled + whole.record.relaxation_steps;
  bool looked = false;
  for (const std::int64_t stop : {end - 9, end - 8, end - 7}) {
    SCOPED_TRACE(::testing::Message() << "stopped after " << stop << " of " << end << " steps");
    EXPECT_EQ(run(1, Decomposition::slab, [&](Options& o) { o.force = true, o.max_steps = stop; }),
              ExitCode::stopped_early);
    const pack::Swing swing = pack::read_state(file("ckpt.A.hdf")).progress.now.swing;
    EXPECT_TRUE(swing.on);
    looked = looked || swing.kinetic_energy > 0.0;
    world_.barrier();
    EXPECT_EQ(run(world_.size(), Decomposition::slab, [](Options& o) { o.restart = "auto"; }), ExitCode::done)
        << words_;
    expect_same(left(), whole);
  }
  EXPECT_TRUE(looked) << "no checkpoint had an energy to compare with";
}

TEST_P(RestartRules, ASignalOnOneRankStopsAll) {
  const Left whole = untouched();
  in_.checkpoint.every = "off";
  EXPECT_EQ(run(world_.size(), Decomposition::slab,
                [&](Options& o) {
                  o.force = true;
                  o.max_steps = layer_steps;
                }),
            ExitCode::stopped_early);
  MPI_Comm part = MPI_COMM_NULL;
  MPI_Comm_dup(MPI_COMM_WORLD, &part);
  {
    const comm::Comm comm(part);
    const Signals signals;
    if (comm.rank() == comm.size() - 1) (void)std::raise(SIGUSR2);
    Options options;
    options.folder = folder_;
    options.restart = "auto";
    options.verbosity = log::Verbosity::quiet;
    try {
      (void)make_pack(comm, scene::build(in_), options);
      ADD_FAILURE() << "was not stopped";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::stopped_early) << error.what();
      EXPECT_NE(std::string(error.what()).find("a signal"), std::string::npos);
    }
  }
  MPI_Comm_free(&part);
  EXPECT_EQ(run(1, Decomposition::slab, [](Options& o) { o.restart = "auto"; }), ExitCode::done) << words_;
  expect_same(left(), whole);
}

// Before anything is there, and at the second layer's beginning.
TEST_P(RestartRules, StoppedInAnInsertion) {
  const Left whole = untouched();
  EXPECT_EQ(run(1, Decomposition::slab, [](Options& o) { o.force = true, o.max_hours = 1e-9; }),
            ExitCode::stopped_early);
  EXPECT_NE(words_.find("step 0 in layer 0"), std::string::npos) << words_;
  in_.checkpoint.every = "100000 steps";  // so only layers' ends
  EXPECT_EQ(
      run(world_.size(), Decomposition::pencil, [](Options& o) { o.restart = "auto", o.max_steps = layer_steps + 10; }),
      ExitCode::stopped_early)
      << words_;
  const std::string newer = file(
      pack::read_state(file("ckpt.A.hdf")).progress.now.phase == pack::Phase::settling ? "ckpt.A.hdf" : "ckpt.B.hdf");
  world_.barrier();
  if (world_.rank() == 0) fs::remove(newer);
  world_.barrier();
  EXPECT_EQ(run(world_.size(), Decomposition::slab, [](Options& o) { o.restart = "auto", o.max_hours = 1e-9; }),
            ExitCode::stopped_early);
  EXPECT_NE(words_.find(std::to_string(layer_steps) + " in layer 1"), std::string::npos) << words_;
  EXPECT_EQ(run(1, Decomposition::slab, [](Options& o) { o.restart = "auto"; }), ExitCode::done) << words_;
  expect_same(left(), whole);
}

// The names of the slots mean nothing: the newest valid one is taken.
TEST_P(RestartRules, SwappedSlots) {
  const Left whole = untouched();
  in_.checkpoint.every = "60 steps";
  EXPECT_EQ(run(world_.size(), Decomposition::slab, [](Options& o) { o.force = true, o.max_steps = layer_steps + 70; }),
            ExitCode::stopped_early);
  if (world_.rank() == 0) {
    const std::int64_t a = pack::read_state(file("ckpt.A.hdf")).serial;
    const std::int64_t b = pack::read_state(file("ckpt.B.hdf")).serial;
    EXPECT_EQ(std::abs(a - b), 1);
    fs::rename(file("ckpt.A.hdf"), file("ckpt"));
    fs::rename(file("ckpt.B.hdf"), file("ckpt.A.hdf"));
    fs::rename(file("ckpt"), file("ckpt.B.hdf"));
  }
  world_.barrier();
  // one step more: the newest was at the end of the steps made so far
  EXPECT_EQ(run(world_.size(), Decomposition::slab, [](Options& o) { o.restart = "auto", o.max_steps = 1; }),
            ExitCode::stopped_early);
  EXPECT_NE(words_.find("step " + std::to_string(layer_steps + 71)), std::string::npos) << words_;
  EXPECT_EQ(run(1, Decomposition::slab, [](Options& o) { o.restart = "auto"; }), ExitCode::done) << words_;
  expect_same(left(), whole);
}

TEST_P(RestartRules, AnotherSceneIsRefusedByItsKeys) {
  EXPECT_EQ(run(1, Decomposition::slab, [](Options& o) { o.force = true, o.max_steps = 10; }), ExitCode::stopped_early);
  input::Input other = in_;
  other.effective = "seed = 2\n[layers]\nfraction = 0.2\n[output]\ncontacts = true\n";
  for (const std::string& from : {std::string("auto"), file("ckpt.A.hdf")}) {
    EXPECT_EQ(run(other, world_.size(), Decomposition::slab, [&](Options& o) { o.restart = from; }),
              ExitCode::bad_checkpoint);
    EXPECT_NE(words_.find("seed: 1 before, 2 now;"), std::string::npos) << words_;
    EXPECT_EQ(words_.find("output"), std::string::npos) << words_;
  }
  EXPECT_EQ(run(1, Decomposition::slab, [](Options&) {}), ExitCode::bad_input);  // an unfinished run is there
  EXPECT_NE(words_.find("--restart auto"), std::string::npos) << words_;
}

TEST_P(RestartRules, DamagedCheckpointsAreToldAndNothingIsLost) {
  EXPECT_EQ(run(1, Decomposition::slab, [](Options& o) { o.force = true, o.max_steps = 10; }), ExitCode::stopped_early);
  if (world_.rank() == 0) fs::resize_file(file("ckpt.A.hdf"), 1000);
  world_.barrier();
  EXPECT_EQ(run(world_.size(), Decomposition::slab, [](Options& o) { o.restart = "auto"; }), ExitCode::bad_checkpoint);
  EXPECT_NE(words_.find(file("ckpt.A.hdf")), std::string::npos) << words_;
  EXPECT_EQ(run(world_.size(), Decomposition::slab, [&](Options& o) { o.restart = file("nowhere"); }),
            ExitCode::bad_checkpoint);
  EXPECT_TRUE(fs::exists(file("ckpt.A.hdf")));
}

// A checkpoint of a stranger: every digest is right, and what it says cannot be.
class Forged : public Restart {
 protected:
  using Change = std::function<void(std::vector<double>& radius, pack::Histories& contacts)>;

  void expect_refused(const std::string& reason, const Change& change) {
    const std::string path = file("ckpt.A.hdf");
    EXPECT_EQ(run(1, Decomposition::slab, [](Options& o) { o.force = true, o.max_steps = layer_steps; }),
              ExitCode::stopped_early);
    if (world_.rank() == 0) forge(path, change);
    world_.barrier();
    for (const int ranks : {1, world_.size()}) {
      EXPECT_EQ(run(ranks, Decomposition::slab, [&](Options& o) { o.restart = path; }), ExitCode::bad_checkpoint);
      EXPECT_NE(words_.find(path), std::string::npos) << words_;
      EXPECT_NE(words_.find(reason), std::string::npos) << words_;
    }
  }

 private:
  static void forge(const std::string& path, const Change& change) {
    const comm::Comm alone(MPI_COMM_SELF);
    particles::Store store(particles::layout_of(3, true)), forged(store.layout());
    pack::Histories contacts;
    const pack::RunState state = pack::read_checkpoint(alone, path, store, &contacts);
    ASSERT_FALSE(contacts.rows.empty());
    std::vector<double> radius;
    for (LocalIndex i = 0; i < store.owned(); ++i) radius.push_back(store.radius(i));
    change(radius, contacts);
    for (LocalIndex i = 0; i < store.owned(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      forged.add(store.ids()[k], store.position(i), radius[k], store.velocity(i), store.spin(i));
    }
    const std::array<const particles::Store*, 1> stores{&forged};
    pack::write_checkpoint(alone, path, stores, state, contacts.here());
  }
};
INSTANTIATE_TEST_SUITE_P(OneScene, Forged, ::testing::Values(kinds.back()), kind_name);

TEST_P(Forged, RadiiOutsideOfTheScene) {
  expect_refused("the radius 1e-300 m, the smallest of its scene is",
                 [](auto& radius, auto&) { radius.back() = 1e-300; });
  expect_refused("the radius 1 m, the largest of its scene is", [](auto& radius, auto&) { radius.front() = 1.0; });
}

TEST_P(Forged, ContactsWithEndsThatCannotBe) {
  const GlobalId other_shape = GetParam().round ? -2 : -7;  // a side of a box, the mantle of a cylinder
  for (const GlobalId other : {GlobalId{1} << 40, GlobalId{-6}, other_shape, GlobalId{-8}, INT64_MIN}) {
    expect_refused("has ends that cannot be", [&](auto&, auto& contacts) { contacts.rows.back().other = other; });
  }
  expect_refused("has ends that cannot be",
                 [](auto&, auto& contacts) { contacts.rows.back().other = contacts.rows.back().holder; });
}

TEST_P(Forged, ContactsThatAreThereTwice) {
  expect_refused("is there twice", [](auto&, auto& contacts) { contacts.rows.push_back(contacts.rows.front()); });
}

TEST_P(Forged, SpringsThatAreNotFiniteOrTooLong) {
  expect_refused("tangential_displacement that is not finite",
                 [](auto&, auto& contacts) { contacts.rows.front().values[1] = std::nan(""); });
  expect_refused("twisting_displacement that is not finite",
                 [](auto&, auto& contacts) { contacts.rows.back().values[6] = HUGE_VAL; });
  for (const std::size_t value : {0U, 4U, 6U}) {
    expect_refused("friction holds at most",
                   [&](auto&, auto& contacts) { contacts.rows.front().values[value] = -1.0; });
  }
}

// Of a law that has no memory, or other springs.
TEST_P(Forged, ContactsOfAnotherLaw) {
  const char* const reason = "what its contacts remember is not what those of the scene do";
  expect_refused(reason, [](auto&, auto& contacts) { contacts = {}; });
  expect_refused(reason, [](auto&, auto& contacts) { contacts.features.rolling = false; });
}

TEST_P(RestartRules, AutoWithoutACheckpointBeginsAtTheBeginning) {
  EXPECT_EQ(run(world_.size(), Decomposition::slab, [](Options& o) { o.restart = "auto"; }), ExitCode::done) << words_;
  const Left whole = left();
  EXPECT_EQ(run(1, Decomposition::slab, [](Options& o) { o.restart = "auto"; }), ExitCode::bad_input);  // finished
  expect_same(left(), whole);
}

TEST_P(RestartRules, AStopFile) {
  if (world_.rank() == 0) {
    fs::create_directories(folder_);
    std::ofstream(folder_ + "/STOP");
  }
  world_.barrier();
  EXPECT_EQ(run(world_.size(), Decomposition::slab, [](Options&) {}), ExitCode::bad_input);
  EXPECT_NE(words_.find("STOP"), std::string::npos);
}

TEST_P(RestartRules, TimeIsUp) {
  EXPECT_EQ(run(world_.size(), Decomposition::slab, [](Options& o) { o.max_hours = 1e-9; }), ExitCode::stopped_early);
  EXPECT_NE(words_.find("time limit"), std::string::npos);
  EXPECT_EQ(run(1, Decomposition::slab, [](Options& o) { o.restart = "auto"; }), ExitCode::done) << words_;
}

TEST(SceneChange, OnlyWhatChangesBits) {
  const std::string before =
      "seed = 1\n\n[layers]\nmaximum = 0\n\n[dynamics]\nwindow = 0\nrelaxation = \"auto\"\n\n[output]\nlog_every = "
      "0.1\n";
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string now = before;
    now.replace(now.find(from), from.size(), to);
    return pack::forbidden_changes(before, now);
  };
  EXPECT_EQ(pack::forbidden_changes(before, before), "");
  EXPECT_EQ(with("maximum = 0", "maximum = 9"), "");
  EXPECT_EQ(with("log_every = 0.1", "log_every = 0.2"), "");
  EXPECT_EQ(with("seed = 1", "seed = 2"), "seed: 1 before, 2 now");
  EXPECT_EQ(with("window = 0", "window = 2"), "dynamics.window: 0 before, 2 now");
  EXPECT_EQ(with("seed = 1\n", ""), "seed: 1 before, absent now");
}

}  // namespace
}  // namespace packmpi::run
