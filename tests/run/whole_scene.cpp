// One scene with all that a report speaks of: graded spheres that spin and slide, a window, the final relaxation. What
// is reported is found again from the rows of the pack, by definitions written out here.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "input/read.hpp"
#include "pack/pack.hpp"
#include "run/analyze.hpp"
#include "run/make_pack.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;

constexpr double length = 0.24, height = 0.16, gravity = 2.0, density = 1000.0;
constexpr double own_modulus = 1e7 / (1.0 - 0.25 * 0.25);  // E / (1 - nu^2)
constexpr const char* scene_text =
    "[container]\nsize = [0.24, 0.24, 0.16]\nboundary = [\"periodic\", \"periodic\"]\n"
    "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e7\npoisson_ratio = 0.25\n"
    "radius = { distribution = \"uniform\", min = 0.014, max = 0.02, weighting = \"number\" }\n"
    "[layers]\nthickness = 0.08\nfraction = 0.22\nduration = 0.5\nspin = [3.0, 0.0, 1.0]\n[jamming]\ngravity = 2.0\n"
    "[contact]\nfriction = 0.4\n[dynamics]\nwindow = 1\nrelaxation = 1.5\ntime_step = 4.0e-4\n"
    "[output]\ncontacts = true\nlog_every = 0.01\n";

double cubed(double x) { return x * x * x; }
double mass_of(double r) { return density * 4.0 / 3.0 * std::numbers::pi * cubed(r); }
double squared(const Vec3& a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

using Row = std::map<std::string, double>;  // of NAME.steps.csv, by the columns' names without units

std::vector<Row> read_series(const std::string& path) {
  std::ifstream file(path);
  std::string line, cell;
  std::getline(file, line);
  std::vector<std::string> names;
  for (std::istringstream cells(line); std::getline(cells, cell, ',');) {
    names.push_back(cell.substr(0, cell.find(" [")));
  }
  std::vector<Row> rows;
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    for (std::size_t k = 0; std::getline(cells, cell, ','); ++k) rows.back()[names.at(k)] = std::stod(cell);
  }
  return rows;
}

// What the run left, made once for all tests.
struct Made {
  report::RunRecord record;
  pack::PackRows rows;
  std::vector<Row> series;
  nlohmann::json analysis;
};

const Made& made() {
  static const Made all = [] {
    const comm::Comm comm(MPI_COMM_WORLD);
    Options options;
    options.folder = fs::temp_directory_path() / ("packmpi_whole_" + std::to_string(::getppid()));
    options.force = true;
    options.verbosity = log::Verbosity::quiet;
    Made run;
    run.record = make_pack(comm, scene::build(input::parse(scene_text, "whole.toml", {})), options);
    comm.barrier();
    (void)analyze(comm, options.folder + "/whole.hdf");
    comm.barrier();
    run.rows = pack::read_pack(options.folder + "/whole.hdf");
    run.series = read_series(options.folder + "/whole.steps.csv");
    run.analysis = nlohmann::json::parse(std::ifstream(options.folder + "/whole.analysis.json"));
    comm.barrier();
    if (comm.rank() == 0) fs::remove_all(options.folder);
    comm.barrier();
    return run;
  }();
  return all;
}

double sum_over(const std::function<double(std::size_t)>& term) {
  long double sum = 0.0L;
  for (std::size_t k = 0; k < made().rows.id.size(); ++k) sum += static_cast<long double>(term(k));
  return static_cast<double>(sum);
}

// Touching pairs, by the definition; floor contacts come as a pair with itself.
struct Contact {
  std::size_t i, j;
  double overlap;
};

const std::vector<Contact>& contacts() {
  static const std::vector<Contact> all = [] {
    const pack::PackRows& rows = made().rows;
    std::vector<Contact> found;
    for (std::size_t i = 0; i < rows.id.size(); ++i) {
      if (rows.position[i][2] < rows.radius[i]) found.push_back({i, i, rows.radius[i] - rows.position[i][2]});
      for (std::size_t j = i + 1; j < rows.id.size(); ++j) {
        const Vec3 &a = rows.position[i], &b = rows.position[j];
        const double apart =
            std::hypot(std::remainder(a[0] - b[0], length), std::remainder(a[1] - b[1], length), a[2] - b[2]);
        if (apart < rows.radius[i] + rows.radius[j]) found.push_back({i, j, rows.radius[i] + rows.radius[j] - apart});
      }
    }
    return found;
  }();
  return all;
}

TEST(WholeScene, StandsAtItsHeightAndAtRest) {
  const report::RunRecord& record = made().record;
  EXPECT_TRUE(record.reached);
  EXPECT_GE(record.relaxations, 1);
  EXPECT_GT(record.layers.size(), 3U);
  EXPECT_EQ(record.particles, static_cast<std::int64_t>(made().rows.id.size()));
  EXPECT_NEAR(record.floor_force, record.weight, 0.02 * record.weight);
  EXPECT_NEAR(record.weight, sum_over([](auto k) { return mass_of(made().rows.radius[k]) * gravity; }), 1e-12);
}

TEST(WholeScene, TheLastRowOfTheSeriesIsThePackItself) {
  const pack::PackRows& rows = made().rows;
  const Row& last = made().series.back();
  const double spin = sum_over(
      [&](auto k) { return 0.2 * mass_of(rows.radius[k]) * squared(rows.spin[k]) * rows.radius[k] * rows.radius[k]; });
  const double kinetic =
      spin + sum_over([&](auto k) { return 0.5 * mass_of(rows.radius[k]) * squared(rows.velocity[k]); });
  const double potential = sum_over([&](auto k) { return mass_of(rows.radius[k]) * gravity * rows.position[k][2]; });
  double elastic = 0.0;  // 8/15 E* sqrt(r*) overlap^(5/2)
  for (const Contact& c : contacts()) {
    const double ri = rows.radius[c.i], rj = rows.radius[c.j];
    const double reduced = c.i == c.j ? ri : ri * rj / (ri + rj);
    elastic += 8.0 / 15.0 * (c.i == c.j ? 1.0 : 0.5) * own_modulus * std::sqrt(reduced) * std::pow(c.overlap, 2.5);
  }
  EXPECT_NEAR(last.at("kinetic energy"), kinetic, 1e-6 * kinetic);
  EXPECT_NEAR(last.at("rotational energy"), spin, 1e-6 * spin);
  EXPECT_NEAR(last.at("potential energy"), potential, 1e-6 * potential);
  EXPECT_NEAR(last.at("elastic energy"), elastic, 1e-6 * elastic);
  EXPECT_NEAR(made().record.kinetic_energy, kinetic, 1e-10 * kinetic);
  const double n = static_cast<double>(rows.id.size());
  EXPECT_NEAR(last.at("mean height"), sum_over([&](auto k) { return rows.position[k][2]; }) / n, 1e-6);
  EXPECT_EQ(last.at("moving"), n);
  for (std::size_t a = 0; a < 3; ++a) {
    const double p = sum_over([&](auto k) { return mass_of(rows.radius[k]) * rows.velocity[k][a]; });
    EXPECT_NEAR(last.at(std::string("momentum ") + "xyz"[a]), p, 1e-9);
  }
}

// Only damping and friction take energy, a little at a time, whether particles freeze, are released or are inserted.
TEST(WholeScene, EnergyIsDissipatedSteadilyThroughFreezingAndRelease) {
  const std::vector<Row>& series = made().series;
  int frozen = 0, released = 0;
  for (std::size_t k = 1; k < series.size(); ++k) {
    const Row &before = series[k - 1], &now = series[k];
    const double energy = now.at("kinetic energy") + now.at("potential energy");
    const double taken = now.at("dissipated") - before.at("dissipated");
    EXPECT_GT(taken, -2e-3 * energy) << "step " << now.at("step");
    EXPECT_LT(taken, 0.1 * energy) << "step " << now.at("step");
    frozen += before.at("layer") > 0.0 && now.at("layer") > before.at("layer") ? 1 : 0;
    released += now.at("moving") > 1.5 * before.at("moving") ? 1 : 0;
  }
  EXPECT_GE(frozen, 2);
  EXPECT_EQ(released, made().record.relaxations);
}

// One particle at a time is taken away that has fewer contacts, until there is none.
std::vector<bool> held_by_three_and_their_weight() {
  std::vector<bool> held(made().rows.id.size(), true);
  const auto touching = [&](std::size_t k) {
    return std::ranges::count_if(contacts(),
                                 [&](const Contact& c) { return (c.i == k && held[c.j]) || (c.j == k && held[c.i]); });
  };
  for (std::size_t k = 0; k < held.size(); ++k) {
    if (!held[k] || touching(k) >= 3) continue;
    held[k] = false;
    k = static_cast<std::size_t>(-1);  // from the beginning
  }
  return held;
}

TEST(WholeScene, ContactsAndRattlersByTheDefinition) {
  const pack::PackRows& rows = made().rows;
  const report::RunRecord& record = made().record;
  const double n = static_cast<double>(rows.id.size());
  std::vector<int> touching(rows.id.size(), 0);
  double pairs = 0.0, overlap = 0.0;
  for (const Contact& c : contacts()) {
    if (c.i == c.j) continue;
    ++touching[c.i], ++touching[c.j];
    pairs += 1.0;
    overlap += c.overlap / std::min(rows.radius[c.i], rows.radius[c.j]);
  }
  EXPECT_EQ(std::vector<int>(rows.contacts.begin(), rows.contacts.end()), touching);
  const observe::Network& network = record.rest.network;
  EXPECT_NEAR(network.coordination, 2.0 * pairs / n, 1e-12);
  EXPECT_NEAR(record.rest.mean_overlap, overlap / pairs, 1e-9);
  const std::vector<bool> held = held_by_three_and_their_weight();
  const auto left = static_cast<double>(std::ranges::count(held, true));
  EXPECT_NEAR(network.rattlers, 1.0 - left / n, 1e-12);
  const auto between_held = [&](const Contact& c) { return c.i != c.j && held[c.i] && held[c.j]; };
  EXPECT_NEAR(network.held_coordination,
              2.0 * static_cast<double>(std::ranges::count_if(contacts(), between_held)) / left, 1e-12);
}

TEST(WholeScene, TheSolidFractionOfTheBulkIsThatOfItsSlices) {
  const pack::PackRows& rows = made().rows;
  const auto below = [&](std::size_t k, double plane) {  // volume of a cap of the height that is below
    const double r = rows.radius[k], h = std::clamp(plane - rows.position[k][2] + r, 0.0, 2.0 * r);
    return std::numbers::pi * h * h * (3.0 * r - h) / 3.0;
  };
  const double bulk = sum_over([&](auto k) { return below(k, 0.8 * height) - below(k, 0.2 * height); });
  EXPECT_NEAR(made().record.phi_bulk, bulk / (length * length * 0.6 * height), 1e-12);
  EXPECT_NEAR(made().record.phi, sum_over([&](auto k) { return below(k, height); }) / (length * length * height),
              1e-12);
  const double local = made().analysis.at("local_density").at("mean");
  EXPECT_NEAR(local, made().record.phi_bulk, 0.03) << "cells fill the bulk";
}

// At rest the vertical stress at a height is the weight above it over the area; the mean over the bulk likewise.
TEST(WholeScene, TheVerticalStressIsTheWeightAboveOverTheArea) {
  const pack::PackRows& rows = made().rows;
  const double weight = sum_over([&](auto k) {
    const double share = std::clamp((rows.position[k][2] - 0.2 * height) / (0.6 * height), 0.0, 1.0);
    return mass_of(rows.radius[k]) * gravity * share;
  });
  const double expected = weight / (length * length);
  const double found = made().analysis.at("forces").at("stress")[2][2];
  EXPECT_NEAR(found, expected, 0.03 * expected);
}

TEST(WholeScene, TheCorrelationOfRadiusAndHeightIsPearsons) {
  const pack::PackRows& rows = made().rows;
  const double n = static_cast<double>(rows.id.size());
  const double r = sum_over([&](auto k) { return rows.radius[k]; }) / n;
  const double z = sum_over([&](auto k) { return rows.position[k][2]; }) / n;
  const double rz = sum_over([&](auto k) { return (rows.radius[k] - r) * (rows.position[k][2] - z); });
  const double rr = sum_over([&](auto k) { return (rows.radius[k] - r) * (rows.radius[k] - r); });
  const double zz = sum_over([&](auto k) { return (rows.position[k][2] - z) * (rows.position[k][2] - z); });
  const double found = made().analysis.at("segregation").at("correlation");
  EXPECT_NEAR(found, rz / std::sqrt(rr * zz), 1e-9);
  EXPECT_GT(std::abs(found), 1e-4);
  EXPECT_NEAR(made().record.mean_radius, r, 1e-15);
  EXPECT_NEAR(made().record.sd_radius, std::sqrt(rr / n), 1e-15);
}

}  // namespace
}  // namespace packmpi::run
