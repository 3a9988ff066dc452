// Every number that a run reports of its energies, its rest and its compaction, against values by hand or found in
// another way.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

#include "observe/measure.hpp"
#include "run/bed.hpp"
#include "run/make_pack.hpp"
#include "support/scenes.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;

constexpr double own_modulus = 1e8 / (1.0 - 0.25 * 0.25);  // E / (1 - nu^2) of test::small_input()
constexpr double gravity = 2.0;

double mass_of(double r) { return 1000.0 * 4.0 / 3.0 * std::numbers::pi * r * r * r; }

struct Sphere {
  Vec3 x;
  double r;
  Vec3 v, w;
};

double dotted(const Vec3& a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

// Kinetic energy with spin, j = 2/5 m r^2, and the part of spin in it.
double spin_energy(const Sphere& s) { return 0.5 * 0.4 * mass_of(s.r) * s.r * s.r * dotted(s.w); }
double kinetic_energy(const Sphere& s) { return 0.5 * mass_of(s.r) * dotted(s.v) + spin_energy(s); }
double potential_energy(const Sphere& s) { return mass_of(s.r) * gravity * s.x[2]; }

// A touching pair across the rank border at half the length, a sphere in the floor, one at a side, one in the air.
const std::vector<Sphere>& spheres() {
  static const std::vector<Sphere> all{{{0.485, 0.25, 0.3}, 0.02, {0.3, -0.1, 0.2}, {4.0, 0.0, -3.0}},
                                       {{0.5348, 0.25, 0.3}, 0.03, {0.0, 0.2, 0.0}, {0.0, 5.0, 0.0}},
                                       {{0.2, 0.5, 0.0249}, 0.025, {0.0, 0.0, -0.5}, {1.0, 2.0, 3.0}},
                                       {{0.9702, 0.5, 0.4}, 0.03, {0.7, 0.0, 0.0}, {}},
                                       {{0.7, 0.7, 0.8}, 0.022, {0.1, 0.2, -0.9}, {0.0, 0.0, 10.0}}};
  return all;
}

struct Placed {
  comm::Comm comm{MPI_COMM_WORLD};
  scene::Scene scene;
  Bed bed;
  explicit Placed(const input::Input& in) : scene(scene::build(in)), bed(comm, scene) {
    for (const Sphere& s : spheres()) {
      if (bed.ownership.owner(bed.ownership.grid().column(s.x)) == comm.rank()) {
        bed.store.add(bed.progress.count, s.x, s.r, s.v, s.w);
      }
      ++bed.progress.count;
    }
    bed.neighborhood.rebuild(bed.store);
  }
  [[nodiscard]] observe::Ledger now() const {
    return observe::ledger(comm, bed.store, scene, bed.stepper.law(), bed.neighborhood, bed.progress.moving_from);
  }
};

TEST(Reported, EnergiesAndMomentumByHand) {
  const Placed placed(test::graded_input(3, 1.0, 0.02, 1.5));
  const observe::Ledger now = placed.now();
  double kinetic = 0.0, spin = 0.0, potential = 0.0, height = 0.0, fastest = 0.0;
  Vec3 momentum{};
  for (const Sphere& s : spheres()) {
    kinetic += kinetic_energy(s);
    spin += spin_energy(s);
    potential += potential_energy(s);
    height += s.x[2] / 5.0;
    fastest = std::max(fastest, std::sqrt(dotted(s.v)));
    for (std::size_t a = 0; a < 3; ++a) momentum[a] += mass_of(s.r) * s.v[a];
  }
  const auto hertz = [](double modulus, double radius, double overlap) {  // the integral of 4/3 E* sqrt(r*) x^1.5
    return 8.0 / 15.0 * modulus * std::sqrt(radius) * std::pow(overlap, 2.5);
  };
  const double elastic = hertz(0.5 * own_modulus, 0.02 * 0.03 / 0.05, 0.05 - (0.5348 - 0.485)) +
                         hertz(own_modulus, 0.025, 1e-4) + hertz(own_modulus, 0.03, 0.9702 + 0.03 - 1.0);
  EXPECT_NEAR(now.kinetic_energy, kinetic, 1e-13 * kinetic);
  EXPECT_NEAR(now.rotational_energy, spin, 1e-13 * spin);
  EXPECT_NEAR(now.potential_energy, potential, 1e-13 * potential);
  EXPECT_NEAR(now.elastic_energy, elastic, 1e-9 * elastic);
  EXPECT_NEAR(now.mean_height, height, 1e-15);
  EXPECT_NEAR(now.max_speed, fastest, 1e-15);
  for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(now.momentum[a], momentum[a], 1e-15);
  const double given = observe::energy_of(placed.comm, placed.bed.store, placed.scene, 0, 5);
  EXPECT_NEAR(given, kinetic + potential, 1e-13 * given);
  const double of_two = observe::energy_of(placed.comm, placed.bed.store, placed.scene, 1, 3);
  EXPECT_NEAR(of_two,
              kinetic_energy(spheres()[1]) + potential_energy(spheres()[1]) + kinetic_energy(spheres()[2]) +
                  potential_energy(spheres()[2]),
              1e-13 * of_two);
}

TEST(Reported, FrozenParticlesTakeTheirEnergyAlongAndBringBackThatOfTheirHeight) {
  input::Input in = test::graded_input(3, 1.0, 0.02, 1.5);
  in.dynamics.window = 1;
  Placed placed(in);
  Bed& bed = placed.bed;
  bed.progress.first_ids = {0, 2};
  const double all = observe::energy_of(placed.comm, bed.store, placed.scene, 0, 5);
  bed.progress.energy_given = all;
  double frozen = 0.0, frozen_height = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    frozen += kinetic_energy(spheres()[k]) + potential_energy(spheres()[k]);
    frozen_height += potential_energy(spheres()[k]);
  }
  bed.freeze_older();
  bed.balance();
  EXPECT_EQ(bed.progress.moving_from, 2);
  EXPECT_NEAR(bed.progress.energy_given, all - frozen, 1e-13 * all);
  const observe::Ledger less = placed.now();
  EXPECT_NEAR(less.kinetic_energy + less.potential_energy, bed.progress.energy_given, 1e-13 * all)
      << "nothing was lost";
  bed.release();
  bed.balance();
  EXPECT_EQ(bed.progress.moving_from, 0);
  EXPECT_NEAR(bed.progress.energy_given, all - frozen + frozen_height, 1e-13 * all);
  const observe::Ledger again = placed.now();
  EXPECT_NEAR(again.kinetic_energy + again.potential_energy, bed.progress.energy_given, 1e-13 * all)
      << "nothing was lost";
}

TEST(Reported, TheFloorIsPushedHarderByWhatComesThanByWhatGoes) {
  Placed placed(test::graded_input(3, 1.0, 0.02, 1.5));
  const double r = 0.025, overlap = 1e-4, speed = 0.5;
  const double elastic = 4.0 / 3.0 * own_modulus * std::sqrt(r) * std::pow(overlap, 1.5);
  const double damping = 2.0 * 0.1 * std::sqrt(2.0 * own_modulus * mass_of(r)) * std::pow(r * overlap, 0.25);
  const auto force = [&] {
    return observe::floor_force(placed.comm, placed.bed.store, placed.scene, placed.bed.neighborhood.walls());
  };
  EXPECT_NEAR(force(), elastic + damping * speed, 1e-9 * force());
  const particles::Layout& layout = placed.bed.store.layout();
  for (LocalIndex i = 0; i < placed.bed.store.owned(); ++i) placed.bed.store.record(i)[layout.velocity + 2] = 0.01;
  EXPECT_NEAR(force(), elastic - damping * 0.01, 1e-9 * force());
  EXPECT_LT(damping * 0.01, elastic);
}

// A coarse layer that falls onto the floor, by runs of the whole program.
input::Input brick() {
  input::Input in = test::graded_input(3, 0.4, 0.018, 1.25);
  in.name = "reported";
  in.container.size = {0.4, 0.4, 0.1};
  in.layers.thickness = 0.12;
  in.layers.fraction = 0.22;
  in.layers.duration = 0.3;
  in.layers.maximum = 1;
  in.drag.coefficient = 0.005;
  in.dynamics.time_step = 2e-4;
  in.output.log_every = 0.002;
  return in;
}

// Rows of NAME.steps.csv by the names of the columns, units left out.
using Series = std::vector<std::map<std::string, double>>;

struct Made {
  report::RunRecord record;
  Series series;
};

Series read_series(const std::string& path) {
  std::ifstream file(path);
  std::string line, cell;
  std::getline(file, line);
  std::vector<std::string> names;
  for (std::istringstream cells(line); std::getline(cells, cell, ',');)
    names.push_back(cell.substr(0, cell.find(" [")));
  Series series;
  while (std::getline(file, line)) {
    series.emplace_back();
    std::istringstream cells(line);
    for (std::size_t k = 0; std::getline(cells, cell, ','); ++k) series.back()[names.at(k)] = std::stod(cell);
  }
  return series;
}

Made pack(const input::Input& in) {
  const comm::Comm comm(MPI_COMM_WORLD);
  Options options;
  options.folder = fs::temp_directory_path() / ("packmpi_reported_" + std::to_string(::getppid()));
  options.force = true;
  options.verbosity = log::Verbosity::quiet;
  Made run{.record = make_pack(comm, scene::build(in), options), .series = {}};
  comm.barrier();
  run.series = read_series(options.folder + "/reported.steps.csv");
  comm.barrier();
  if (comm.rank() == 0) fs::remove_all(options.folder);
  comm.barrier();
  return run;
}

TEST(Reported, TheCompactionRateIsTheRiseOfTheSolidFractionOverTheLastTenth) {
  input::Input in = brick();
  const report::RunRecord whole = pack(in).record;
  in.layers.duration = 0.27;
  const report::RunRecord shorter = pack(in).record;
  EXPECT_GT(std::abs(whole.compaction_rate), 0.01);
  EXPECT_NEAR(whole.compaction_rate, (whole.phi_bulk - shorter.phi_bulk) / 0.03, 1e-9);
}

TEST(Reported, TheKineticEnergyOfALayerIsInWeightsTimesADiameter) {
  const report::RunRecord record = pack(brick()).record;
  const double diameter = 2.0 * 1.125 * 0.018;  // the mean of the scene's
  ASSERT_EQ(record.layers.size(), 1U);
  EXPECT_GT(record.layers[0].kinetic_per_mgd, 0.01);
  EXPECT_NEAR(record.layers[0].kinetic_per_mgd, record.kinetic_energy / (record.weight * diameter), 1e-12);
}

// The series of a layer that runs its whole duration says when one that stops at rest must end: at the first look after
// `hold` at whose every look since the energy and the drift were below their limits.
TEST(Reported, ALayerEndsAtRestWhenItsSeriesSaysSo) {
  input::Input in = brick();
  in.layers.duration = 1.2;
  in.output.log_every = 0.002;
  const Made whole = pack(in);
  const double diameter = 2.0 * 1.125 * 0.018;
  const double weight = whole.record.weight;
  const double interval = 0.002;  // between looks [s]
  const auto energy = [&](std::size_t k) { return whole.series[k].at("kinetic energy") / (weight * diameter); };
  const auto drift = [&](std::size_t k) {
    const double before = k > 0 ? whole.series[k - 1].at("mean height") : 0.0;
    return std::abs(whole.series[k].at("mean height") - before) / interval / std::sqrt(gravity * diameter);
  };
  const auto expected_end = [&](double most_energy, double most_drift) {
    std::size_t since = 0;  // looks in a row, up to ten intervals
    for (std::size_t k = 0; k < whole.series.size(); ++k) {
      const bool touching = whole.series[k].at("elastic energy") > 0.0;  // else no force is balanced
      since = touching && energy(k) < most_energy && drift(k) < most_drift ? since + 1 : 0;
      if (since == 11) return static_cast<std::int64_t>(k + 1) * 10;
    }
    return std::int64_t{0};
  };
  in.dynamics.stop = input::StopRule::settled;
  in.dynamics.settled_hold = 10.0 * interval;
  in.dynamics.settled_force = 1e9;
  for (const auto& [most_energy, most_drift] : {std::pair{0.02, 1e9}, std::pair{1e9, 0.02}, std::pair{0.01, 0.03}}) {
    in.dynamics.settled_energy = most_energy;
    in.dynamics.settled_drift = most_drift;
    const report::LayerRow row = pack(in).record.layers.at(0);
    EXPECT_EQ(row.stop_reason, "settled");
    EXPECT_EQ(row.steps, expected_end(most_energy, most_drift)) << most_energy << " " << most_drift;
  }
}

}  // namespace
}  // namespace packmpi::run
