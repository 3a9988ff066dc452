// Lists, ghosts and migration against brute force over all pairs, on every rank count and decomposition.
#include "neighbor/neighborhood.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <map>
#include <random>
#include <set>

#include "support/scenes.hpp"

namespace packmpi::neighbor {
namespace {

using Pair = std::pair<GlobalId, GlobalId>;

struct Ball {
  Vec3 x, v, omega;
  double r;
  bool still = false;  // frozen
};

// The same cloud on every rank.
std::vector<Ball> cloud(const scene::Scene& scene, std::size_t count) {
  std::mt19937_64 bits(7);
  const auto u = [&bits](double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11U) * 0x1p-53;
  };
  std::vector<Ball> balls(count);
  for (Ball& b : balls) {
    b.r = u(scene.sizes.smallest(), scene.sizes.largest());
    if (scene.sizes.equal()) b.r = scene.sizes.largest();
    for (int a = 0; a < scene.container.dimension; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      b.x[axis] = u(0.0, scene.container.size[axis]);
      b.v[axis] = u(-1.0, 1.0);
    }
    b.omega = scene.container.dimension == 3 ? Vec3{u(-1, 1), u(-1, 1), u(-1, 1)} : Vec3{0, 0, u(-1, 1)};
  }
  return balls;
}

double distance(const geometry::Container& box, const Vec3& a, const Vec3& b) {
  double squared = 0.0;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(box.dimension); ++axis) {
    double d = std::abs(a[axis] - b[axis]);
    if (axis < static_cast<std::size_t>(box.lateral_axes()) && box.periodic[axis]) d = std::min(d, box.size[axis] - d);
    squared += d * d;
  }
  return std::sqrt(squared);
}

// A bed in this test: balls dealt out to whatever rank, brought home by the first rebuild.
struct World {
  World(const comm::Comm& comm, const input::Input& in, std::size_t count)
      : scene(scene::build(in)),
        ownership(comm, scene.columns(), in.parallel.decomposition),
        store(scene.features.layout()),
        hood(comm, scene, ownership),
        balls(cloud(scene, count)) {
    for (std::size_t k = 0; k < count; ++k) {
      if (static_cast<int>(k * k % static_cast<std::size_t>(comm.size())) != comm.rank()) continue;
      store.add(static_cast<GlobalId>(k), balls[k].x, balls[k].r, balls[k].v, balls[k].omega);
    }
    hood.rebuild(store);
    EXPECT_EQ(hood.follow(store, 0.0, time_step()), Alarm::none);  // makes the step known
    hood.arrive(store);
    hood.rebuild(store);
  }
  [[nodiscard]] double time_step() const { return 0.06 * scene.skin; }
  scene::Scene scene;
  scene::Ownership ownership;
  particles::Store store;
  Neighborhood hood;
  std::vector<Ball> balls;
};

std::set<GlobalId> owned_ids(const particles::Store& store) {
  const auto ids = store.ids().first(static_cast<std::size_t>(store.owned()));
  return {ids.begin(), ids.end()};
}

// Pairs of the list by id; every pair at most once, and first ascending, second above first.
std::set<Pair> listed(const particles::Store& store, const PairList& list) {
  std::set<Pair> pairs;
  for (std::size_t p = 0; p < list.first.size(); ++p) {
    EXPECT_LT(list.first[p], list.second[p]);
    EXPECT_LT(list.first[p], store.owned());
    if (p > 0) {
      EXPECT_LE(list.first[p - 1], list.first[p]);
    }
    if (list.second[p] < store.owned()) {
      EXPECT_LT(list.second[p] - list.first[p], list.window);
    }
    const GlobalId a = store.ids()[static_cast<std::size_t>(list.first[p])];
    const GlobalId b = store.ids()[static_cast<std::size_t>(list.second[p])];
    EXPECT_TRUE(pairs.insert(std::minmax(a, b)).second) << a << " " << b;
  }
  return pairs;
}

// Radius and margin of each ball when lists were made.
std::function<double(const Ball&)> extents(const World& w) {
  double fastest = 0.0;
  for (const Ball& b : w.balls) {
    if (!b.still) fastest = std::max(fastest, norm(b.v));
  }
  Margins margins(w.scene);
  margins.plan(fastest, w.time_step());
  return [margins](const Ball& b) { return b.r + (b.still ? 0.0 : margins.of(norm(b.v))); };
}

template <class Cut>
std::set<Pair> expected(const World& w, Cut cut) {
  const std::set<GlobalId> mine = owned_ids(w.store);
  std::set<Pair> pairs;
  for (std::size_t i = 0; i < w.balls.size(); ++i) {
    for (std::size_t j = i + 1; j < w.balls.size(); ++j) {
      const Pair pair{static_cast<GlobalId>(i), static_cast<GlobalId>(j)};
      if (!mine.contains(pair.first) && !mine.contains(pair.second)) continue;
      if (distance(w.scene.container, w.balls[i].x, w.balls[j].x) < cut(w.balls[i], w.balls[j])) pairs.insert(pair);
    }
  }
  return pairs;
}

std::vector<input::Input> scenes() {
  std::vector<input::Input> all;
  for (const int dimension : {2, 3}) {
    const double r = dimension == 2 ? 0.03 : 0.05;
    for (const auto& in : {test::small_input(dimension, 2.0, r), test::graded_input(dimension, 2.0, 0.5 * r, 2.0)}) {
      all.push_back(in);
      all.push_back(test::periodic(in));
    }
  }
  for (const int dimension : {2, 3}) {  // lists by size class
    const auto wide = test::graded_input(dimension, 2.0, 0.005, 20.0);
    all.push_back(wide);
    all.push_back(test::periodic(wide));
  }
  all.push_back(test::periodic(test::small_input(3, 2.0, 0.05)));
  all.back().near_field = input::NearField{1e-6, 2.0, 0.0, 0.0, 0.16};
  std::vector<input::Input> decomposed;
  for (const input::Input& in : all) {
    for (const auto kind : {input::Decomposition::slab, input::Decomposition::pencil, input::Decomposition::metis}) {
      decomposed.push_back(in);
      decomposed.back().parallel.decomposition = kind;
    }
  }
  return decomposed;
}

TEST(Neighborhood, ListsEveryPairWithinTheCutOnceOnEachRankThatOwnsAnEnd) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const input::Input& in : scenes()) {
    const World w(comm, in, 700);
    const auto reach = extents(w);
    EXPECT_EQ(listed(w.store, w.hood.pairs()),
              expected(w, [&](const Ball& a, const Ball& b) { return reach(a) + reach(b); }));
    if (!in.near_field) continue;
    const double cut = in.near_field->cutoff + w.scene.skin;
    EXPECT_EQ(listed(w.store, w.hood.near_pairs()), expected(w, [cut](const Ball&, const Ball&) { return cut; }));
  }
}

// What is frozen is in pairs with the moving only, wherever it lies, and comes back at rest where it was.
TEST(Neighborhood, FrozenParticlesAreWallsToTheMovingOnes) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const input::Input& in : scenes()) {
    World w(comm, in, 700);
    const auto met = [&w] {
      return expected(w, [reach = extents(w)](const Ball& a, const Ball& b) { return reach(a) + reach(b); });
    };
    for (const GlobalId below : {150, 500}) {  // the second joins the first
      for (GlobalId k = 0; k < below; ++k) w.balls[static_cast<std::size_t>(k)].still = true;
      w.hood.freeze(w.store, below);
      w.hood.rebuild(w.store);
      EXPECT_EQ(comm.sum(std::int64_t{w.store.owned()}), 700 - below);
      EXPECT_EQ(comm.sum(std::int64_t{w.hood.frozen().owned()}), below);
      EXPECT_EQ(listed(w.store, w.hood.pairs()), met());
      if (!in.near_field) continue;
      const double near = in.near_field->cutoff + w.scene.skin;
      EXPECT_EQ(listed(w.store, w.hood.near_pairs()), expected(w, [near](const Ball&, const Ball&) { return near; }));
    }
    w.hood.release(w.store);
    w.hood.rebuild(w.store);
    for (std::size_t k = 0; k < 500; ++k) w.balls[k].still = false, w.balls[k].v = {};
    EXPECT_EQ(listed(w.store, w.hood.pairs()), met());
    for (LocalIndex i = 0; i < w.store.owned(); ++i) {
      const auto id = w.store.ids()[static_cast<std::size_t>(i)];
      const Ball& ball = w.balls[static_cast<std::size_t>(id)];
      EXPECT_EQ(w.store.position(i), ball.x);
      EXPECT_EQ(w.store.velocity(i), ball.v);
      if (id < 500) {
        EXPECT_EQ(w.store.spin(i), Vec3{});
      }
    }
  }
}

TEST(Neighborhood, MigrationLosesNothingAndBringsEveryoneHome) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const input::Input& in : scenes()) {
    const World w(comm, in, 300);
    EXPECT_EQ(comm.sum(std::int64_t{w.store.owned()}), 300);
    std::vector<std::int64_t> seen(300, 0);
    for (LocalIndex i = 0; i < w.store.owned(); ++i) {
      EXPECT_EQ(w.ownership.owner(w.ownership.grid().column(w.store.position(i))), comm.rank());
      const auto id = static_cast<std::size_t>(w.store.ids()[static_cast<std::size_t>(i)]);
      ++seen[id];
      EXPECT_EQ(w.store.position(i), w.balls[id].x);
      EXPECT_EQ(w.store.radius(i), w.balls[id].r);
      EXPECT_EQ(w.store.velocity(i), w.balls[id].v);
    }
    comm.sum(seen);
    for (const std::int64_t n : seen) EXPECT_EQ(n, 1);
  }
}

TEST(Neighborhood, WallListHoldsWhoeverIsWithinItsMarginOfAWall) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const World w(comm, test::graded_input(3, 2.0, 0.03, 2.0), 500);
  std::map<std::pair<GlobalId, Wall>, int> got;
  for (std::size_t k = 0; k < w.hood.walls().particle.size(); ++k) {
    ++got[{w.store.ids()[static_cast<std::size_t>(w.hood.walls().particle[k])], w.hood.walls().wall[k]}];
    if (k > 0) {
      EXPECT_LE(w.hood.walls().particle[k - 1], w.hood.walls().particle[k]);
    }
  }
  const auto reach = extents(w);
  for (const GlobalId id : owned_ids(w.store)) {
    const Ball& b = w.balls[static_cast<std::size_t>(id)];
    const double range = reach(b);
    const std::array<std::pair<Wall, bool>, 5> walls{{{Wall::floor, b.x[2] < range},
                                                      {Wall::x_low, b.x[0] < range},
                                                      {Wall::x_high, 2.0 - b.x[0] < range},
                                                      {Wall::y_low, b.x[1] < range},
                                                      {Wall::y_high, 2.0 - b.x[1] < range}}};
    for (const auto& [wall, near] : walls) EXPECT_EQ((got.contains({id, wall})), near);
  }
}

// Moves every owned particle by a step of its velocity, as the dynamics would, wrapping periodic axes.
double move(World& w, double dt) {
  double fastest = 0.0;
  for (LocalIndex i = 0; i < w.store.owned(); ++i) {
    double* record = w.store.record(i);
    const particles::Layout& layout = w.store.layout();
    double squared = 0.0;
    for (int a = 0; a < layout.dimension; ++a) {
      const auto axis = static_cast<std::size_t>(a);
      double& v = record[layout.velocity + a];
      double& x = record[a];
      x += v * dt;
      if (a < w.scene.container.lateral_axes() && w.scene.container.periodic[axis]) {
        x = geometry::wrap(x, w.scene.container.size[axis]);
      } else if (x < 0.0 || x > w.scene.container.size[axis]) {
        v = -v;
      }
      squared += v * v;
    }
    fastest = std::max(fastest, squared);
  }
  return std::sqrt(fastest);
}

TEST(Neighborhood, FollowsMotionWithoutMissingATouchAndGhostsCarryTheirOwnersBits) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const input::Input& in : scenes()) {
    World w(comm, in, 300);
    const double dt = w.time_step();
    for (int step = 0; step < 60; ++step) {
      const double fastest = move(w, dt);
      ASSERT_EQ(w.hood.follow(w.store, fastest, dt), Alarm::none);
      w.hood.arrive(w.store);
    }
    EXPECT_GT(w.hood.rebuilds(), 3);
    EXPECT_LT(w.hood.rebuilds(), 60);
    // Everyone's present state, by id, through an order-free sum of bits (each id is owned once).
    std::vector<std::int64_t> bits(300 * 5, 0);
    const auto state = [&](LocalIndex i, std::int64_t* out) {
      const Vec3 x = w.store.position(i);
      const Vec3 v = w.store.velocity(i);
      std::memcpy(out, x.data(), sizeof x);
      std::memcpy(out + 3, v.data(), 2 * sizeof(double));
    };
    for (LocalIndex i = 0; i < w.store.owned(); ++i)
      state(i, &bits[5 * static_cast<std::size_t>(w.store.ids()[static_cast<std::size_t>(i)])]);
    comm.sum(bits);
    for (LocalIndex i = w.store.owned(); i < w.store.total(); ++i) {
      std::array<std::int64_t, 5> ghost{};
      state(i, ghost.data());
      const std::int64_t* owner = &bits[5 * static_cast<std::size_t>(w.store.ids()[static_cast<std::size_t>(i)])];
      EXPECT_TRUE(std::equal(ghost.begin(), ghost.end(), owner));
    }
    for (std::size_t k = 0; k < 300; ++k) std::memcpy(w.balls[k].x.data(), &bits[5 * k], sizeof(Vec3));
    // All that touch now are in the lists made a while ago.
    const std::set<Pair> pairs = listed(w.store, w.hood.pairs());
    for (const Pair& pair : expected(w, [](const Ball&a, const Ball&b) { return a.r + b.r; })) {
      EXPECT_TRUE(pairs.contains(pair)) << pair.first << " " << pair.second;
    }
  }
}

TEST(Neighborhood, AFaultOnOneRankIsKnownToAll) {
  const comm::Comm comm(MPI_COMM_WORLD);
  World w(comm, test::small_input(3, 2.0, 0.05), 100);
  const bool last = comm.rank() == comm.size() - 1;
  EXPECT_EQ(w.hood.follow(w.store, 0.0, 1e-4, last ? Alarm::fault : Alarm::look), Alarm::fault);
  EXPECT_EQ(w.hood.follow(w.store, 0.0, 1e-4, last ? Alarm::look : Alarm::none), Alarm::look);
  EXPECT_EQ(w.hood.follow(w.store, 0.0, 1e-4), Alarm::none);
  EXPECT_EQ(w.hood.follow(w.store, comm.rank() == 0 ? std::nan("") : 0.0, 1e-4), Alarm::fault);
  w.hood.arrive(w.store);
}

TEST(Neighborhood, AParticleOutsideIsAFaultOnceListsAreDue) {
  const comm::Comm comm(MPI_COMM_WORLD);
  World w(comm, test::small_input(3, 2.0, 0.05), 100);
  for (LocalIndex i = 0; i < w.store.owned(); ++i) {
    if (w.store.ids()[static_cast<std::size_t>(i)] == 42) w.store.record(i)[2] = -0.06;  // further out than a radius
  }
  const std::int64_t before = w.hood.rebuilds();
  EXPECT_EQ(w.hood.follow(w.store, 0.1, 0.2 * w.scene.skin / 0.1), Alarm::none);
  EXPECT_EQ(w.hood.follow(w.store, 0.1, w.scene.most_margin / 0.1), Alarm::fault);
  EXPECT_EQ(w.hood.rebuilds(), before);
  w.hood.arrive(w.store);
}

TEST(Neighborhood, AParticleFlungUpCostsNoMemory) {
  const comm::Comm comm(MPI_COMM_WORLD);
  World w(comm, test::small_input(3, 2.0, 0.05), 100);
  const std::size_t before = w.hood.bytes();
  for (LocalIndex i = 0; i < w.store.owned(); ++i) {
    if (w.store.ids()[static_cast<std::size_t>(i)] == 42) w.store.record(i)[2] = 1e12;
  }
  w.hood.rebuild(w.store);
  EXPECT_LT(w.hood.bytes(), 20 * before);
}

// Steps in which every owned particle is stamped with the number of the step when its leg is done: whatever a leg
// reads of a ghost must bear the stamp of the step before.
TEST(Sweep, GhostsArriveBeforeTheyAreReadAndAreSentWhenDone) {
  const comm::Comm comm(MPI_COMM_WORLD);
  std::int64_t met = 0;  // ghosts that were read
  for (const input::Input& in : scenes()) {
    World w(comm, in, 700);
    particles::Store& store = w.store;
    const int stamp = store.layout().velocity;
    for (LocalIndex i = 0; i < store.owned(); ++i) store.record(i)[stamp] = 0.0;
    w.hood.refresh_ghosts(store);
    const PairList& pairs = w.hood.pairs();
    for (int step = 1; step <= 3; ++step) {
      LocalIndex done = 0;
      std::int64_t pair = 0;
      std::array<int, 2> ended{}, begun{};
      for (const Leg& leg : w.hood.sweep()) {
        ASSERT_TRUE(leg.end > done || store.owned() == 0);
        for (const std::size_t half : {0U, 1U}) {
          if (leg.needs[half]) w.hood.end_refresh(halves[half], store);
          ended[half] += leg.needs[half] ? 1 : 0;
        }
        for (; pair < leg.pairs_end; ++pair) {
          const LocalIndex i = pairs.first[static_cast<std::size_t>(pair)];
          const LocalIndex j = pairs.second[static_cast<std::size_t>(pair)];
          ASSERT_TRUE(done <= i && i < leg.end);
          if (j < store.owned()) continue;
          EXPECT_EQ(store.record(j)[stamp], step - 1);
          ++met;
        }
        for (; done < leg.end; ++done) store.record(done)[stamp] = step;
        for (const std::size_t half : {0U, 1U}) {
          if (leg.sends[half]) w.hood.begin_refresh(halves[half], store);
          begun[half] += leg.sends[half] ? 1 : 0;
        }
      }
      EXPECT_EQ(done, store.owned());
      EXPECT_EQ(pair, std::ssize(pairs.first));
      EXPECT_EQ(w.hood.sweep().back().walls_end, std::ssize(w.hood.walls().particle));
      EXPECT_EQ(ended, (std::array{1, 1}));
      EXPECT_EQ(begun, (std::array{1, 1}));
    }
    w.hood.arrive(store);
    for (const Half half : halves) {
      for (const LocalIndex ghost : w.hood.halo().ghosts(half)) EXPECT_EQ(store.record(ghost)[stamp], 3);
    }
  }
  EXPECT_EQ(comm.sum(met) > 1000, comm.size() > 1);
}

TEST(Halo, CarriesOnlyWhatTheSceneUses) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const int dimension : {2, 3}) {
    for (const bool rotation : {false, true}) {
      input::Input in = test::small_input(dimension, 2.0, dimension == 2 ? 0.03 : 0.05);
      in.dynamics.rotation = rotation;
      World w(comm, in, 300);
      const auto ghost_bytes = [&] {
        return comm.counters().sent[static_cast<std::size_t>(comm::Purpose::ghosts)].bytes;
      };
      const std::int64_t before = ghost_bytes();
      ASSERT_EQ(w.hood.follow(w.store, 0.0, 1e-4), Alarm::none);
      w.hood.arrive(w.store);
      const std::int64_t sent = comm.sum(ghost_bytes() - before);
      const int doubles = 2 * dimension + (rotation ? (dimension == 3 ? 3 : 1) : 0);
      EXPECT_EQ(sent, comm.sum(std::int64_t{w.store.ghosts()}) * 8 * doubles);
    }
  }
}

}  // namespace
}  // namespace packmpi::neighbor
