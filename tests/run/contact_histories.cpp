// Contacts that remember, on many ranks against one: after every step both owners of a border pair hold the very bits
// that a single rank has, through rebuilds, migration, freezing, the final relaxation and a restart.
#include <gtest/gtest.h>

#include <map>
#include <random>

#include "run/bed.hpp"
#include "scene/pair_channels.hpp"
#include "support/scenes.hpp"

namespace packmpi::run {
namespace {

using Ends = std::pair<GlobalId, GlobalId>;
using Histories = std::map<Ends, std::vector<double>>;

// A box that is filled to the rim and shaken up: many contacts, and particles that cross from rank to rank.
input::Input scene_of(int dimension, bool graded, bool periodic, bool rolling) {
  constexpr double r = 0.02;
  input::Input in =
      graded ? test::graded_input(dimension, 0.9, 0.6 * r, 1.0 / 0.6) : test::small_input(dimension, 0.9, r);
  if (dimension == 3) in.container.size = {0.9, 0.24, 0.2};
  if (periodic) in = test::periodic(in);
  in.contact.tangential = input::Tangential::mindlin;
  in.contact.rolling_friction = rolling ? 0.1 : 0.0;
  in.contact.twisting_friction = rolling && dimension == 3 ? 0.1 : 0.0;
  in.particles.youngs_modulus = 1e7;
  in.jamming.gravity = 10.0;
  in.dynamics.time_step = 1e-4;
  in.dynamics.window = 1;
  return in;
}

constexpr std::size_t per_row = 22;

// A grid of overlapping particles, some rows high; each rank adds every size-th.
void fill(Bed& bed) {
  std::mt19937_64 bits(7);
  const auto u = [&bits] { return static_cast<double>(bits() >> 11U) * 0x1p-53; };
  const scene::Scene& scene = bed.scene;
  const auto rows = static_cast<std::size_t>(scene.container.dimension == 3 ? 6 : 1);
  const double apart = 1.95 * scene.sizes.mean();
  for (std::size_t k = 0; k < 5 * rows * per_row; ++k) {
    const std::size_t column = k % per_row, row = k / per_row % rows, level = k / per_row / rows;
    Vec3 x{0.025 + apart * static_cast<double>(column), 0.025 + apart * static_cast<double>(row), 0.0};
    x[static_cast<std::size_t>(scene.container.vertical())] = 0.02 + apart * static_cast<double>(level);
    Vec3 v{3.0 + 2.0 * u(), u(), u() - 1.0};
    Vec3 spin{20.0 * u(), 20.0 * u(), 20.0 * u()};
    if (scene.container.dimension == 2) v = {v[0], v[2], 0.0}, spin = {0.0, 0.0, spin[2]};
    const double r = scene.sizes.smallest() + u() * (scene.sizes.largest() - scene.sizes.smallest());
    if (static_cast<int>(k) % bed.comm.size() == bed.comm.rank()) {
      bed.store.add(static_cast<GlobalId>(k), x, r, v, spin);
    }
  }
  bed.progress.count = static_cast<GlobalId>(5 * rows * per_row);
  bed.neighborhood.rebuild(bed.store);
}

Histories told(const Bed& bed) {
  Histories all;
  bed.neighborhood.each_history(bed.store, [&](const neighbor::ContactHistory& contact) {
    const bool added =
        all.emplace(Ends{contact.first, contact.second}, std::vector(contact.values.begin(), contact.values.end()))
            .second;
    EXPECT_TRUE(added) << contact.first << ' ' << contact.second;
  });
  return all;
}

// Every copy in the lists of this rank.
void expect_listed(const Bed& bed, const Histories& expected) {
  const auto& pairs = bed.neighborhood.pairs();
  const auto& memory = bed.neighborhood.memory();
  const auto signs = scene::stored_signs(bed.scene.features);
  const std::size_t entries = pairs.first.size();
  for (std::size_t p = 0; p < entries; ++p) {
    const GlobalId a = bed.store.ids()[static_cast<std::size_t>(pairs.first[p])];
    const GlobalId b = bed.store.ids()[static_cast<std::size_t>(pairs.second[p])];
    const auto found = expected.find({std::min(a, b), std::max(a, b)});
    for (std::size_t c = 0; c < memory.doubles(); ++c) {
      const double value = (a < b ? 1.0 : signs[c]) * memory.of_pairs()[c * entries + p];
      ASSERT_EQ(value, found == expected.end() ? 0.0 : found->second[c]) << a << ' ' << b << " double " << c;
    }
  }
}

void expect_same(const Bed& bed, const Bed& alone) {
  const Histories expected = told(alone);
  expect_listed(bed, expected);
  const Histories mine = told(bed);
  for (const auto& [ends, values] : mine) {
    const auto found = expected.find(ends);
    ASSERT_TRUE(found != expected.end()) << ends.first << ' ' << ends.second;
    ASSERT_EQ(found->second, values) << ends.first << ' ' << ends.second;
  }
  ASSERT_EQ(bed.comm.sum(std::ssize(mine)), std::ssize(expected));
}

struct Both {
  explicit Both(const comm::Comm& world, const input::Input& in)
      : self(MPI_COMM_SELF), scene(scene::build(in)), alone(self, scene), bed(world, scene) {
    fill(alone);
    fill(bed);
  }
  template <class Act>
  void each(Act act) {
    act(alone);
    act(bed);
  }
  void steps(int count) {
    for (int step = 0; step < count && !::testing::Test::HasFatalFailure(); ++step) {
      each([](Bed& p) { p.stepper.advance(p.store, p.neighborhood, 1); });
      expect_same(bed, alone);
    }
  }
  comm::Comm self;
  scene::Scene scene;
  Bed alone, bed;
};

// A new bed from what another one tells, as a restart would: particles on any rank, with the contacts they hold.
void restart(const Bed& from, Bed& to, GlobalId frozen_below) {
  for (const particles::Store* store : {&from.store, &from.neighborhood.frozen()}) {
    for (LocalIndex i = 0; i < store->owned(); ++i) {
      to.store.add_record(store->ids()[static_cast<std::size_t>(i)], store->record(i));
    }
  }
  const Histories kept = told(from);
  std::vector<neighbor::ContactHistory> rows;
  for (const auto& [ends, values] : kept) rows.push_back({ends.first, ends.second, values});
  to.neighborhood.give(to.store, rows);
  if (frozen_below > 0) to.neighborhood.freeze(to.store, frozen_below);
  to.neighborhood.rebuild(to.store);
}

class ContactHistories : public ::testing::TestWithParam<std::tuple<int, bool, bool, bool>> {};

TEST_P(ContactHistories, AreTheSameBitsOnEveryRankThroughEverything) {
  const auto [dimension, graded, periodic, rolling] = GetParam();
  const comm::Comm world(MPI_COMM_WORLD);
  Both both(world, scene_of(dimension, graded, periodic, rolling));
  both.steps(120);
  const Histories early = told(both.alone);
  EXPECT_GT(early.size(), 30U);
  const GlobalId some = both.bed.progress.count / 3, more = both.bed.progress.count / 2;
  for (const GlobalId below : {some, more}) {
    const Histories before = told(both.alone);
    both.each([&](Bed& p) {
      p.neighborhood.freeze(p.store, below);
      p.neighborhood.rebuild(p.store);
    });
    EXPECT_EQ(told(both.alone), before) << "freezing changes none";
    expect_same(both.bed, both.alone);
    both.steps(40);
  }
  both.each([](Bed& p) { p.balance(); });
  both.steps(10);
  Bed again(world, both.scene);
  restart(both.bed, again, more);
  expect_same(again, both.alone);
  const Histories frozen = told(both.alone);
  both.each([](Bed& p) {
    p.neighborhood.release(p.store);
    p.neighborhood.rebuild(p.store);
  });
  EXPECT_EQ(told(both.alone), frozen) << "nor does releasing";
  expect_same(both.bed, both.alone);
  again.neighborhood.release(again.store);
  again.neighborhood.rebuild(again.store);
  expect_same(again, both.alone);
  both.steps(40);
  EXPECT_GT(both.bed.neighborhood.rebuilds(), 12);
  EXPECT_EQ(world.sum(static_cast<std::int64_t>(particles::digest(both.bed.store))),
            static_cast<std::int64_t>(particles::digest(both.alone.store)));
}

INSTANTIATE_TEST_SUITE_P(Scenes, ContactHistories,
                         ::testing::Values(std::tuple{2, false, true, false}, std::tuple{2, true, false, true},
                                           std::tuple{3, false, false, true}, std::tuple{3, true, true, true},
                                           std::tuple{3, false, true, false}));

TEST(ContactHistories, NothingIsThereWithoutMemory) {
  const comm::Comm world(MPI_COMM_WORLD);
  input::Input in = scene_of(3, false, true, false);
  in.contact.tangential = input::Tangential::sliding;
  const scene::Scene scene = scene::build(in);
  Bed bed(world, scene);
  fill(bed);
  bed.stepper.advance(bed.store, bed.neighborhood, 20);
  EXPECT_FALSE(bed.neighborhood.memory().in_use());
  EXPECT_EQ(bed.neighborhood.memory().bytes(), 0U);
  EXPECT_TRUE(told(bed).empty());
}

}  // namespace
}  // namespace packmpi::run
