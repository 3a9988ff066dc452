// What the counters count: the same in each run, the same in all where they must not depend on the ranks, and nothing
// sent where there is nobody to send to. Runs on 4 ranks and makes smaller communicators of them.
#include "run/counters.hpp"

#include <gtest/gtest.h>

#include <ctime>
#include <filesystem>
#include <map>

#include "base/memory.hpp"
#include "base/timer.hpp"
#include "rsa/insert.hpp"
#include "run/make_pack.hpp"
#include "support/scenes.hpp"

namespace packmpi::run {
namespace {

// Two layers fall on each other; the first is frozen while the second falls, and all move at the end.
input::Input scene_of(input::Decomposition kind) {
  input::Input in = test::periodic(test::small_input(3, 0.6, 0.02));
  in.container.size = {0.44, 0.3, 0.3};
  in.name = "counters";
  in.layers.thickness = 0.1;
  in.layers.fraction = 0.1;  // few rounds of trials
  in.layers.duration = 0.03;
  in.layers.maximum = 2;
  in.layers.velocity = {0.5, 0.3, -2.0};
  in.particles.youngs_modulus = 1e7;
  in.jamming.gravity = 10.0;
  in.dynamics.time_step = 2e-4;
  in.dynamics.window = 1;
  in.dynamics.relaxation = 0.01;
  in.output.log_every = 0.01;
  in.parallel.decomposition = kind;
  return in;
}

// Each run is made once, for all tests.
class Counters : public ::testing::Test {
 protected:
  // Collective over the world. The record of rank 0 on the first `ranks`.
  static report::RunRecord make(int ranks, input::Decomposition kind) {
    const comm::Comm world(MPI_COMM_WORLD);
    const comm::Comm part = world.split(world.rank() < ranks ? 0 : 1);
    report::RunRecord record;
    if (world.rank() < ranks) {
      Options options;
      options.folder = std::filesystem::temp_directory_path() / ("packmpi_counters_" + std::to_string(::getppid()));
      options.force = true;
      options.verbosity = log::Verbosity::quiet;
      record = make_pack(part, scene::build(scene_of(kind)), options);
      part.barrier();
      if (part.rank() == 0) std::filesystem::remove_all(options.folder);
    }
    world.barrier();
    return record;
  }
  static const report::RunRecord& record_on(int ranks, input::Decomposition kind = input::Decomposition::slab) {
    static std::map<std::pair<int, input::Decomposition>, report::RunRecord> made;
    const auto found = made.find({ranks, kind});
    return found != made.end() ? found->second : made[{ranks, kind}] = make(ranks, kind);
  }
};

std::int64_t sum_of(const report::RunRecord& record, const std::string& name) {
  const report::RankNumbers* found = report::find(record.counters, name);
  return found != nullptr ? found->sum() : -1;
}

TEST_F(Counters, DoNotDependOnTheRanksWhereTheyMustNot) {
  const report::RunRecord& one = record_on(1);
  for (const auto& [ranks, kind] : {std::pair{2, input::Decomposition::slab}, std::pair{3, input::Decomposition::slab},
                                    std::pair{4, input::Decomposition::pencil}}) {
    const report::RunRecord& many = record_on(ranks, kind);
    if (many.counters.empty()) continue;  // not rank 0
    SCOPED_TRACE(ranks);
    for (const char* name : {"owned", "touching_pairs", "particle_steps", "frozen_steps"}) {
      EXPECT_EQ(sum_of(many, name), sum_of(one, name)) << name;
    }
    EXPECT_EQ(sum_of(many, "owned"), many.particles);
    EXPECT_EQ(sum_of(many, "particle_steps"), many.particle_steps);
    EXPECT_DOUBLE_EQ(2.0 * static_cast<double>(sum_of(many, "touching_pairs")),
                     many.rest.network.coordination * static_cast<double>(many.particles));
    EXPECT_EQ(report::moving_share(many), report::moving_share(one));
    EXPECT_LT(report::moving_share(many), 1.0);
    EXPECT_GT(sum_of(many, "touching_pairs"), 0);
    for (const char* name : {"ghosts", "ghost_steps", "ghost_messages", "halo_messages", "insertion_messages",
                             "migration_messages", "frozen_messages"}) {
      EXPECT_GT(sum_of(many, name), 0) << name;
    }
    for (const char* name : {"rebuilds", "reductions", "exchanges"}) {  // collective: all ranks alike
      const report::RankNumbers* numbers = report::find(many.counters, name);
      const std::vector<std::int64_t> alike(static_cast<std::size_t>(ranks), numbers != nullptr ? numbers->max() : 0);
      EXPECT_TRUE(numbers != nullptr && numbers->of_rank == alike) << name;
    }
    // A border pair is listed on both sides, another one once.
    EXPECT_GT(sum_of(many, "pair_steps"), sum_of(one, "pair_steps"));
    EXPECT_LT(sum_of(many, "pair_steps"), 2 * sum_of(one, "pair_steps"));
    EXPECT_GE(sum_of(many, "candidates"), sum_of(many, "listed_pairs"));
  }
}

TEST_F(Counters, AloneNothingIsSent) {
  const report::RunRecord& one = record_on(1);
  if (one.counters.empty()) return;  // not rank 0
  ASSERT_GT(one.counters.size(), 12U);
  for (const report::RankNumbers& numbers : one.counters) {
    const bool sent = numbers.name.ends_with("_messages") || numbers.name.ends_with("_bytes");
    if (sent || numbers.name.starts_with("ghost")) {
      EXPECT_EQ(numbers.sum(), 0) << numbers.name;
    }
  }
  EXPECT_GT(sum_of(one, "reductions"), one.steps);  // one a step at least
}

TEST_F(Counters, AreTheSameInEachRun) {
  const report::RunRecord& first = record_on(3);
  const report::RunRecord second = make(3, input::Decomposition::slab);
  ASSERT_EQ(first.counters.size(), second.counters.size());
  for (std::size_t k = 0; k < first.counters.size(); ++k) {
    EXPECT_EQ(first.counters[k].of_rank, second.counters[k].of_rank) << first.counters[k].name;
  }
  if (!first.counters.empty()) {
    ASSERT_FALSE(first.costs.empty());
    const report::RankNumbers* memory = report::find(first.costs, "memory");
    ASSERT_NE(memory, nullptr);
    EXPECT_GT(memory->max(), 1 << 20);  // no MPI program is smaller than a megabyte
  }
}

// Two layers in the air, of which the lower one is frozen.
void insert_two(Bed& bed, double thickness) {
  for (std::uint32_t layer = 0; layer < 2; ++layer) {
    bed.progress.first_ids.push_back(bed.progress.count);
    const rsa::LayerRegion region{layer, thickness * layer, thickness, bed.progress.count};
    bed.progress.count += rsa::insert(bed.comm, bed.scene, bed.ownership, region, bed.store).inserted;
  }
  bed.freeze_older();
  bed.neighborhood.rebuild(bed.store);
}

TEST_F(Counters, AddUpStepByStep) {
  const comm::Comm world(MPI_COMM_WORLD);
  const scene::Scene scene = scene::build(scene_of(input::Decomposition::pencil));
  Bed bed(world, scene);
  insert_two(bed, scene.in.layers.thickness);
  std::map<std::string, std::int64_t> expected{{"rebuilds", bed.neighborhood.rebuilds()}};
  for (int step = 0; step < 120; ++step) {
    expected["particle_steps"] += bed.store.owned();
    expected["frozen_steps"] += bed.neighborhood.frozen().owned();
    expected["ghost_steps"] += bed.neighborhood.halo().ghosts();
    expected["pair_steps"] += std::ssize(bed.neighborhood.pairs().first);
    bed.stepper.advance(bed.store, bed.neighborhood, 1);
  }
  EXPECT_GT(bed.neighborhood.rebuilds(), expected["rebuilds"]);
  expected["rebuilds"] = bed.neighborhood.rebuilds();
  expected["owned"] = bed.store.owned();
  expected["ghosts"] = bed.neighborhood.halo().ghosts();
  expected["listed_pairs"] = std::ssize(bed.neighborhood.pairs().first);
  expected["touching_pairs"] = 1000 + world.rank();
  report::RunRecord record;
  count(bed, 1000 + world.rank(), record);
  for (auto& [name, mine] : expected) {
    const std::vector<std::int64_t> all = world.gather(std::vector<std::int64_t>{mine});
    const report::RankNumbers* found = report::find(record.counters, name);
    if (world.rank() != 0) continue;
    ASSERT_NE(found, nullptr) << name;
    EXPECT_EQ(found->of_rank, all) << name;
    EXPECT_GT(found->sum(), 0) << name;
  }
}

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// What is measured by clocks lies between what the test's own clocks say before and after, and in itself.
TEST_F(Counters, CostsLieBetweenTheClocksAroundThem) {
  const double cpu_before = processor_seconds();
  const std::int64_t memory_before = memory_high_water();
  const Stopwatch watch;
  const report::RunRecord record = make(2, input::Decomposition::slab);
  const double wall = watch.seconds();
  const double cpu_after = processor_seconds();
  const std::int64_t memory_after = memory_high_water();
  if (record.costs.empty()) return;  // not rank 0
  const auto cost = [&](const char* name) { return report::find(record.costs, name)->of_rank.at(0); };
  const auto seconds = [&](const char* name) { return 1e-9 * static_cast<double>(cost(name)); };
  EXPECT_GE(seconds("cpu"), cpu_before);
  EXPECT_LE(seconds("cpu"), cpu_after);
  EXPECT_LE(seconds("stepping") + seconds("inserting"), wall);
  EXPECT_LE(seconds("waiting") + seconds("refreshing") + seconds("rebuilding"), seconds("stepping"));
  for (const char* name : {"stepping", "waiting", "refreshing"}) {
    EXPECT_GT(seconds(name), 1e-9 * static_cast<double>(record.steps)) << name;  // no step is done in a nanosecond
  }
  EXPECT_GT(seconds("rebuilding"), 1e-9 * static_cast<double>(sum_of(record, "rebuilds")));
  EXPECT_GT(seconds("inserting"), 1e-9 * static_cast<double>(record.particles));
  EXPECT_GE(cost("memory"), memory_before);
  EXPECT_LE(cost("memory"), memory_after);
  EXPECT_LE(cost("allocated"), cost("memory"));
  const std::int64_t here = report::find(record.counters, "owned")->of_rank.at(0);
  EXPECT_GE(cost("allocated"), here * 13 * static_cast<std::int64_t>(sizeof(double)));  // a record each at least
}

// Two ranks are one neighbour each: two messages a step, together position, velocity and spin of each ghost.
TEST_F(Counters, EachHalfOfTheGhostsIsSentOncePerStepAndNeighbour) {
  const report::RunRecord& record = record_on(2);
  if (record.counters.empty()) return;  // not rank 0
  EXPECT_EQ(report::find(record.counters, "ghost_messages")->of_rank, std::vector<std::int64_t>(2, 2 * record.steps));
  constexpr std::int64_t bytes = 9 * 8;
  EXPECT_EQ(sum_of(record, "ghost_bytes"), bytes * sum_of(record, "ghost_steps"));
}

}  // namespace
}  // namespace packmpi::run
