// The ledger of the step log: without losses the energy stays, to the order of the integrator; without walls the
// momentum stays, to rounding; and what is lost is booked as dissipated.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "comm/exact_sum.hpp"
#include "observe/measure.hpp"
#include "rsa/insert.hpp"
#include "run/bed.hpp"
#include "support/scenes.hpp"

namespace packmpi::run {
namespace {

// A layer inserted above the floor, and its energy given.
struct Layer {
  comm::Comm comm{MPI_COMM_WORLD};
  scene::Scene scene;
  Bed bed;
  explicit Layer(const input::Input& in) : scene(scene::build(in)), bed(comm, scene) {
    const rsa::LayerRegion region{0, 0.3, in.layers.thickness, 0};
    bed.progress.count = rsa::insert(comm, scene, bed.ownership, region, bed.store).inserted;
    bed.progress.first_ids = {0};
    bed.progress.energy_given = observe::energy_of(comm, bed.store, scene, 0, bed.progress.count);
    bed.neighborhood.rebuild(bed.store);
  }
  [[nodiscard]] observe::Ledger now() const {
    return observe::ledger(comm, bed.store, scene, bed.stepper.law(), bed.neighborhood);
  }
  void advance(double seconds) {
    bed.stepper.advance(bed.store, bed.neighborhood, std::llround(seconds / scene.time_step));
  }
};

/// Collective. In the tangential, rolling and twisting springs, each contact once.
double spring_energy(const Bed& bed) {
  const auto& pairs = bed.neighborhood.pairs();
  const auto& walls = bed.neighborhood.walls();
  double sum = 0.0;
  const dynamics::Law& law = bed.stepper.law();
  const dynamics::StoredView of_pairs = dynamics::stored_pairs(bed.neighborhood);
  const dynamics::StoredView of_walls = dynamics::stored_walls(bed.neighborhood);
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    const double share = pairs.second[p] < bed.store.owned() ? 1.0 : 0.5;  // of a border both owners have it
    const LocalIndex i = pairs.first[p], j = pairs.second[p];
    const auto entry = static_cast<std::int64_t>(p);
    const double energy = dynamics::pair_contact(bed.scene, law, bed.store, i, j, of_pairs, entry).spring_energy;
    EXPECT_EQ(dynamics::pair_spring_energy(bed.scene, law, bed.store, i, j, of_pairs, entry), energy);
    sum += share * energy;
  }
  for (std::size_t w = 0; w < walls.particle.size(); ++w) {
    const LocalIndex i = walls.particle[w];
    const auto entry = static_cast<std::int64_t>(w);
    const geometry::Facing at = neighbor::facing_of(bed.scene.container, walls, w, bed.store.position(i));
    const double energy = dynamics::wall_contact(bed.scene, law, bed.store, i, at, of_walls, entry).spring_energy;
    EXPECT_EQ(dynamics::wall_spring_energy(bed.scene, law, bed.store, i, at, of_walls, entry), energy);
    sum += energy;
  }
  return comm::exact_sum(bed.comm, std::array{sum});
}

double total(const observe::Ledger& now) { return now.kinetic_energy + now.potential_energy + now.elastic_energy; }

struct Case {
  int dimension;
  bool graded;
};

input::Input lossless(const Case& what, double step) {
  input::Input in =
      what.graded ? test::graded_input(what.dimension, 0.5, 0.02, 1.5) : test::small_input(what.dimension, 0.5, 0.02);
  in.particles.youngs_modulus = 1e7;
  in.layers.thickness = 0.2;
  in.layers.fraction = 0.1;
  in.layers.velocity = {0.7, what.dimension == 3 ? 0.3 : -1.0, what.dimension == 3 ? -1.0 : 0.0};
  in.contact.damping_ratio = in.contact.friction = in.contact.wall_friction = 0.0;
  in.dynamics.time_step = step;
  return in;
}

// Largest departure from the energy given while all collide with all, over that energy.
double worst_departure(const Case& what, double step, double& most_elastic) {
  Layer layer(lossless(what, step));
  double worst = 0.0;
  for (int k = 0; k < 40; ++k) {
    layer.advance(0.01);
    const observe::Ledger now = layer.now();
    worst = std::max(worst, std::abs(total(now) - layer.bed.progress.energy_given));
    most_elastic = std::max(most_elastic, now.elastic_energy / layer.bed.progress.energy_given);
  }
  return worst / layer.bed.progress.energy_given;
}

TEST(Ledger, EnergyStaysToFirstOrderInTheStep) {
  for (const Case& what : {Case{2, false}, Case{2, true}, Case{3, false}, Case{3, true}}) {
    double elastic = 0.0;
    const double coarse = worst_departure(what, 1e-4, elastic);
    const double fine = worst_departure(what, 2e-5, elastic);
    EXPECT_GT(elastic, 0.01) << "nothing collided when it was looked at";
    EXPECT_LT(coarse, 0.02);
    EXPECT_LT(fine, 0.35 * coarse) << "of first order it would be a fifth";
  }
}

// Friction with memory, rolling and twisting between bodies that lose nothing else: what springs hold is in the ledger,
// so that sliders and growing contacts only take; a fall of what they took is the integrator's, of first order.
input::Input holding(const Case& what, double step) {
  input::Input in = lossless(what, step);
  in.contact.tangential = input::Tangential::mindlin;
  in.contact.friction = in.contact.wall_friction = 0.5;
  in.contact.rolling_friction = 0.1;
  in.contact.twisting_friction = what.dimension == 3 ? 0.1 : 0.0;
  in.layers.fraction = 0.2;
  return in;
}

struct Falls {
  double with_springs = 0.0, without = 0.0;  // largest fall of what was dissipated, over the energy given
};

Falls largest_falls(const Case& what, double step) {
  Layer layer(holding(what, step));
  Falls worst;
  double most = 0.0, most_without = 0.0;
  for (int k = 0; k < 800; ++k) {
    layer.advance(2e-4);
    const observe::Ledger now = layer.now();
    const double given = layer.bed.progress.energy_given;
    const double dissipated = (given - total(now)) / given;
    const double without = dissipated + spring_energy(layer.bed) / given;
    worst.with_springs = std::max(worst.with_springs, most - dissipated);
    worst.without = std::max(worst.without, most_without - without);
    most = std::max(most, dissipated), most_without = std::max(most_without, without);
  }
  EXPECT_GT(most, 0.02) << "nothing slid";
  return worst;
}

TEST(Ledger, HoldsTheEnergyOfSprings) {
  for (const Case& what : {Case{2, false}, Case{2, true}, Case{3, false}, Case{3, true}}) {
    const Falls coarse = largest_falls(what, 5e-5);
    const Falls fine = largest_falls(what, 1e-5);
    std::printf("fall of the dissipated energy: %.2e, a fifth of the step %.2e; without springs %.2e, %.2e\n",
                coarse.with_springs, fine.with_springs, coarse.without, fine.without);
    EXPECT_LT(fine.with_springs, 0.4 * coarse.with_springs) << "of first order it would be a fifth";
    EXPECT_GT(fine.without, 3.0 * fine.with_springs) << "the springs would not be missed";
  }
}

// A second layer on the first, which freezes and comes back: each time the ledger changes by what the frozen contacts
// hold of elastic energy, their springs' in it, and by nothing else.
TEST(Ledger, ClosesOverAWindowAndAFinalRelaxation) {
  input::Input in = holding({3, true}, 5e-5);
  in.dynamics.window = 1;
  in.contact.damping_ratio = 0.3;
  Layer layer(in);
  Bed& bed = layer.bed;
  const double scale = bed.progress.energy_given;
  const auto dissipated = [&](const observe::Ledger& now) { return bed.progress.energy_given - total(now); };
  const auto run = [&] {  // losses only grow
    double most = -HUGE_VAL;
    for (int k = 0; k < 100; ++k) {
      layer.advance(1e-3);
      const double now = dissipated(layer.now());
      EXPECT_GT(now, most - 1e-4 * scale);
      most = std::max(most, now);
    }
  };
  const auto change = [&](auto act) {
    const observe::Ledger before = layer.now();
    const double lost = dissipated(before);
    act();
    bed.neighborhood.rebuild(bed.store);
    const observe::Ledger after = layer.now();
    EXPECT_NEAR(dissipated(after) - lost, before.elastic_energy - after.elastic_energy, 1e-12 * scale);
    return after.elastic_energy - before.elastic_energy;
  };
  run();
  EXPECT_EQ(change([&] {
              bed.store.set_ghosts(0);
              const GlobalId first = bed.progress.count;
              const rsa::LayerRegion region{1, bed.top(), in.layers.thickness, first};
              bed.progress.count += rsa::insert(layer.comm, layer.scene, bed.ownership, region, bed.store).inserted;
              bed.progress.first_ids.push_back(first);
              bed.progress.energy_given +=
                  observe::energy_of(layer.comm, bed.store, layer.scene, first, bed.progress.count);
            }),
            0.0);
  EXPECT_LT(change([&] { bed.freeze_older(); }), 0.0);
  EXPECT_GT(bed.progress.moving_from, 0);
  run();
  EXPECT_GT(change([&] { bed.release(); }), 0.0);
  run();
  EXPECT_GT(spring_energy(bed), 0.0);
}

TEST(Ledger, MomentumStaysWithoutWalls) {
  for (const Case& what : {Case{2, false}, Case{2, true}, Case{3, false}, Case{3, true}}) {
    input::Input in = test::periodic(lossless(what, 1e-4));
    in.jamming.gravity = 0.0;
    in.layers.fraction = 0.2;
    in.contact.friction = 0.5;
    in.contact.damping_ratio = 0.2;
    in.layers.velocity = {1.0, 0.0, 0.0};  // eq. (23) wants a speed
    Layer layer(in);
    for (LocalIndex i = 0; i < layer.bed.store.owned(); ++i) {  // every other one the other way, and a spin
      double* record = layer.bed.store.record(i);
      const GlobalId id = layer.bed.store.ids()[static_cast<std::size_t>(i)];
      if (id % 2 == 1) record[layer.bed.store.layout().velocity] = -1.5;
      record[layer.bed.store.layout().spin] = 0.3;
    }
    layer.bed.neighborhood.rebuild(layer.bed.store);
    const observe::Ledger before = layer.now();
    const double sum =
        std::sqrt(2.0 * before.kinetic_energy * observe::motion(layer.comm, layer.bed.store, layer.scene).mass);
    layer.advance(0.1);
    const observe::Ledger after = layer.now();
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(after.momentum[a], before.momentum[a], 1e-13 * sum);
    EXPECT_LT(total(after), 0.9 * total(before));  // they did collide
    EXPECT_GT(after.rotational_energy, 0.0);
  }
}

TEST(Ledger, LossesAreBookedAsDissipated) {  // two spheres head-on, of the literal law's exact restitution
  const double xi = 0.3;
  const double b = xi * std::sqrt(6.0 / 5.0);
  const double restitution = std::exp(-std::numbers::pi * b / std::sqrt(1.0 - b * b));
  input::Input in = test::periodic(lossless({3, false}, 1e-6));
  in.jamming.gravity = 0.0;
  in.contact.damping_ratio = xi;
  in.contact.tension_cutoff = false;
  Layer layer(in);
  const std::vector<LocalIndex> nobody;
  layer.bed.store.keep(nobody);
  for (const int side : {0, 1}) {
    const Vec3 x{0.2299 + 0.0402 * side, 0.25, 0.25};  // on two ranks
    const bool mine = layer.bed.ownership.owner(layer.bed.ownership.grid().column(x)) == layer.comm.rank();
    if (mine) layer.bed.store.add(side, x, 0.02, {side == 0 ? 0.5 : -0.5, 0.0, 0.0}, {});
  }
  layer.bed.neighborhood.rebuild(layer.bed.store);
  layer.bed.progress.energy_given = observe::energy_of(layer.comm, layer.bed.store, layer.scene, 0, 2);
  layer.advance(0.02);
  const double dissipated = layer.bed.progress.energy_given - total(layer.now());
  EXPECT_NEAR(dissipated / layer.bed.progress.energy_given, 1.0 - restitution * restitution, 1e-3);
}

TEST(Ledger, TheSameBitsOnAnyNumberOfRanks) {
  input::Input in = test::periodic(lossless({3, true}, 1e-4));
  Layer all(in);
  all.advance(0.35);
  const comm::Comm self(MPI_COMM_SELF);
  Bed one(self, all.scene);
  one.progress.count =
      rsa::insert(self, all.scene, one.ownership, {0, 0.3, in.layers.thickness, 0}, one.store).inserted;
  one.neighborhood.rebuild(one.store);
  one.stepper.advance(one.store, one.neighborhood, 3500);
  const observe::Ledger a = all.now();
  const observe::Ledger b = observe::ledger(self, one.store, all.scene, one.stepper.law(), one.neighborhood);
  EXPECT_GT(a.elastic_energy, 0.0);
  EXPECT_EQ(a.elastic_energy, b.elastic_energy);
  EXPECT_EQ(a.kinetic_energy, b.kinetic_energy);
  EXPECT_EQ(a.kinetic_energy, observe::motion(self, one.store, all.scene).kinetic_energy);
  EXPECT_EQ(a.potential_energy, b.potential_energy);
  EXPECT_EQ(a.momentum, b.momentum);
  EXPECT_EQ(a.max_speed, b.max_speed);
}

}  // namespace
}  // namespace packmpi::run
