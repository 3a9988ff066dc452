// The measures of `packmpi analyze` on lattices whose values are known, on any number of ranks.
#include "observe/analysis.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <numbers>
#include <numeric>

#include "input/read.hpp"
#include "run/analyze.hpp"
#include "run/bed.hpp"
#include "run/make_pack.hpp"
#include "support/scenes.hpp"

namespace packmpi::run {
namespace {

constexpr double r = 0.02;
constexpr double d = 2.0 * r;
constexpr double range = 2.5 * d;
constexpr double squeeze = 1.0 - 1e-4;  // touching

struct Lattice {
  std::vector<Vec3> points;
  Vec3 size;  // [m]; periodic along x (and y), `size[vertical]` high
};

/// `basis` in cells of the given size, so many along each axis.
Lattice repeat(const std::vector<Vec3>& basis, const Vec3& cell, const std::array<int, 3>& count) {
  Lattice lattice;
  for (std::size_t a = 0; a < 3; ++a) lattice.size[a] = squeeze * cell[a] * count[a];
  for (int k = 0; k < count[2]; ++k) {
    for (int j = 0; j < count[1]; ++j) {
      for (int i = 0; i < count[0]; ++i) {
        for (const Vec3& b : basis) {
          lattice.points.push_back(
              {squeeze * cell[0] * (i + b[0]), squeeze * cell[1] * (j + b[1]), squeeze * cell[2] * (k + b[2])});
        }
      }
    }
  }
  return lattice;
}

Lattice fcc() {
  const double a = d * std::numbers::sqrt2;
  return repeat({{.25, .25, .25}, {.75, .75, .25}, {.75, .25, .75}, {.25, .75, .75}}, {a, a, a}, {8, 8, 8});
}

Lattice hcp() {
  const double h = std::sqrt(8.0 / 3.0) * d;
  return repeat({{.25, .25, .25}, {.75, .75, .25}, {.25, .25 + 1.0 / 3.0, .75}, {.75, .75 + 1.0 / 3.0 - 1.0, .75}},
                {d, std::numbers::sqrt3 * d, h}, {12, 7, 7});
}

Lattice simple_cubic() { return repeat({{.5, .5, .5}}, {d, d, d}, {10, 10, 10}); }

Lattice hexagonal() { return repeat({{.25, .25, 0}, {.75, .75, 0}}, {d, std::numbers::sqrt3 * d, 0.0}, {16, 9, 1}); }

Lattice square() { return repeat({{.5, .5, 0}}, {d, d, 0.0}, {16, 16, 1}); }

class Analysis : public ::testing::Test {
 protected:
  const comm::Comm comm_{MPI_COMM_WORLD};

  [[nodiscard]] observe::Analysis of(const Lattice& lattice, int dimension) const {
    return of(lattice, test::small_input(dimension, 1.0, r), range, [](std::size_t) { return r; });
  }

  /// Of a lattice in which particle k has the radius radius_of(k), by an analysis that reaches so far.
  [[nodiscard]] observe::Analysis of(const Lattice& lattice, const input::Input& with, double reach,
                                     const std::function<double(std::size_t)>& radius_of) const {
    input::Input in = test::periodic(with);
    in.container.size.assign(lattice.size.begin(), lattice.size.begin() + in.container.dimension);
    in.layers.thickness = 0.2;
    scene::Scene scene = scene::build(in);
    scene.in.near_field = input::NearField{.alpha1 = 0, .beta1 = 0, .alpha2 = 0, .beta2 = 0, .cutoff = reach};
    scene.reach = reach;
    Bed bed(comm_, scene);
    GlobalId id = 0;
    for (const Vec3& x : lattice.points) {  // by turns, wherever it belongs
      if (id % comm_.size() == comm_.rank()) bed.store.add(id, x, radius_of(static_cast<std::size_t>(id)), {}, {});
      ++id;
    }
    bed.neighborhood.rebuild(bed.store);
    return observe::analyse(observe::specimen_of(comm_, scene, bed.store, bed.neighborhood, reach));
  }
};

TEST_F(Analysis, FaceCentredCubic) {
  const observe::Analysis a = of(fcc(), 3);
  EXPECT_EQ(a.particles, 2048);
  EXPECT_NEAR(a.order.q4, 0.190941, 1e-5);
  EXPECT_NEAR(a.order.q6, 0.574524, 1e-5);
  EXPECT_EQ(a.order.fcc, 1.0);
  EXPECT_EQ(a.order.hcp, 0.0);
  EXPECT_EQ(a.local.left_out, 0);
  EXPECT_NEAR(a.local.mean * std::pow(squeeze, 3), std::numbers::pi / std::sqrt(18.0), 1e-9);
  EXPECT_LT(a.local.sd, 1e-6);
  EXPECT_NEAR(a.rest.network.coordination, 12.0 - 8.0 * 128.0 / 2048.0, 1e-12) << "four bonds less at top and bottom";
  EXPECT_EQ(a.rest.network.rattlers, 0.0);
  EXPECT_NEAR(a.forces.fabric[0][0] + a.forces.fabric[1][1] + a.forces.fabric[2][2], 1.0, 1e-12);
  EXPECT_NEAR(a.forces.fabric[0][0], a.forces.fabric[1][1], 1e-12);
  EXPECT_NEAR(a.forces.fabric[0][1], 0.0, 1e-12);
  EXPECT_GT(a.forces.stress[2][2], 0.0) << "pressed together: compression is positive";
  EXPECT_EQ(a.segregation.correlation, 0.0);
}

TEST_F(Analysis, PairDistributionCountsTheShells) {
  const observe::Analysis a = of(fcc(), 3);
  ASSERT_GT(a.pairs.centres, 0);
  // 12, 6, 24, 12, 24 neighbours at 1, sqrt 2, sqrt 3, 2, sqrt 5 diameters; the integral of 4 pi r^2 n g over a shell.
  const auto shell = [&](double from, double to) {
    double count = 0.0;
    const double n = std::numbers::sqrt2;  // per cubed diameter
    for (std::size_t k = 0; k < a.pairs.g.values.size(); ++k) {
      const double low = a.pairs.g.width * static_cast<double>(k), high = low + a.pairs.g.width;
      if (low < from || high > to) continue;
      count += 4.0 / 3.0 * std::numbers::pi * (high * high * high - low * low * low) * n * a.pairs.g.values[k];
    }
    return count;
  };
  // The density is that of the interior, whose cut through the lattice is uneven: a tenth. (APlainCount is exact.)
  EXPECT_NEAR(shell(0.9, 1.2) / 12.0, shell(1.6, 1.9) / 24.0, 1e-9);
  EXPECT_NEAR(shell(1.3, 1.5) / 6.0, shell(2.1, 2.4) / 24.0, 1e-9);
  EXPECT_NEAR(shell(0.9, 1.2), 12.0, 3.0);
  EXPECT_EQ(shell(0.0, 0.9), 0.0);
  EXPECT_EQ(shell(1.1, 1.3), 0.0);
}

/// Points as even as random ones never are: the additive sequence of the plastic number's powers.
Lattice even_gas(int count) {
  constexpr double g = 1.2207440846057596;
  Lattice gas{.points = {}, .size = {1.0, 1.0, 1.0}};
  const auto share = [](double x) { return x - std::floor(x); };
  for (int k = 1; k <= count; ++k) {
    gas.points.push_back({share(0.5 + k / g), share(0.5 + k / (g * g)), share(0.5 + k / (g * g * g))});
  }
  return gas;
}

/// Mean over the lateral columns, a diameter wide, of the highest top.
double surface_of(const Lattice& lattice) {
  const auto columns = static_cast<std::size_t>(1.0 / d);
  std::vector<double> tops(columns * columns, 0.0);
  for (const Vec3& x : lattice.points) {
    const auto at = [&](double t) { return static_cast<std::size_t>(t * static_cast<double>(columns)); };
    double& top = tops[at(x[0]) * columns + at(x[1])];
    top = std::max(top, x[2] + r);
  }
  return std::accumulate(tops.begin(), tops.end(), 0.0) / static_cast<double>(tops.size());
}

TEST_F(Analysis, PairDistributionIsAPlainCountAndOneInAGas) {
  const Lattice gas = even_gas(4000);
  const observe::Analysis a = of(gas, 3);
  const double high = std::min(surface_of(gas) - range, 0.8);
  std::vector<double> pairs(a.pairs.g.values.size(), 0.0);
  double centres = 0.0;
  for (const Vec3& x : gas.points) {
    if (!(x[2] >= 0.2 && x[2] < high)) continue;
    centres += 1.0;
    for (const Vec3& y : gas.points) {
      const auto apart = [&](std::size_t axis) { return std::remainder(y[axis] - x[axis], 1.0); };
      const double distance = std::hypot(apart(0), apart(1), y[2] - x[2]);
      const auto bin = static_cast<std::size_t>(distance / d * 50.0);
      if (&x != &y && bin < pairs.size()) pairs[bin] += 1.0;
    }
  }
  EXPECT_EQ(static_cast<double>(a.pairs.centres), centres);
  ASSERT_EQ(pairs.size(), 125U);
  const double density = centres / (high - 0.2);
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const double inner = static_cast<double>(k) * d / 50.0, outer = static_cast<double>(k + 1) * d / 50.0;
    const double shell = 4.0 / 3.0 * std::numbers::pi * (std::pow(outer, 3) - std::pow(inner, 3));
    EXPECT_NEAR(a.pairs.g.values[k], pairs[k] / (centres * density * shell), 1e-9 * (1.0 + a.pairs.g.values[k])) << k;
  }
  const double found = std::accumulate(pairs.begin(), pairs.end(), 0.0) / centres;
  EXPECT_NEAR(found / (4000.0 * 4.0 / 3.0 * std::numbers::pi * std::pow(range, 3)), 1.0, 0.02);
}

TEST_F(Analysis, ForcesOfASqueezedLatticeAreHertzAndItsStressIsTheForceOverTheArea) {
  const observe::Analysis a = of(repeat({{.5, .5, .5}}, {d, d, d}, {10, 10, 11}), 3);
  const double own_modulus = 1e8 / (1.0 - 0.25 * 0.25);  // E* of a pair is half of it, against the rigid floor all
  const double length = squeeze * d;
  const double force = 4.0 / 3.0 * (0.5 * own_modulus) * std::sqrt(0.5 * r) * std::pow(d - length, 1.5);
  // Of the 11 planes 7 are in the bulk, and 6 of the 10 gaps between them: 2.2 to 8.8 distances above the floor.
  EXPECT_EQ(a.forces.contacts, 100 * (7 + 7 + 6));
  EXPECT_NEAR(a.forces.mean_normal_force, force, 1e-9 * force);
  const double pressure = force / (length * length);
  EXPECT_NEAR(a.forces.stress[0][0], 7.0 / 6.6 * pressure, 1e-9 * pressure);
  EXPECT_NEAR(a.forces.stress[1][1], 7.0 / 6.6 * pressure, 1e-9 * pressure);
  EXPECT_NEAR(a.forces.stress[2][2], 6.0 / 6.6 * pressure, 1e-9 * pressure);
  EXPECT_NEAR(a.forces.stress[0][2], 0.0, 1e-9 * pressure);
  EXPECT_NEAR(a.forces.fabric[0][0], 0.35, 1e-12);
  EXPECT_NEAR(a.forces.fabric[2][2], 0.30, 1e-12);
  const double on_floor = 4.0 / 3.0 * own_modulus * std::sqrt(r) * std::pow(r - 0.5 * length, 1.5);
  EXPECT_NEAR(a.floor_force, 100.0 * on_floor, 1e-9 * a.floor_force);
  const double mass = 1000.0 * 4.0 / 3.0 * std::numbers::pi * r * r * r;
  EXPECT_NEAR(a.weight, 1100.0 * mass * 2.0, 1e-9 * a.weight);
}

// Planes of large and small spheres in turn: radical cells are boxes, and the planes between them are nearer to the
// small ones by (R^2 - r^2) / 2 h, h their distance.
TEST_F(Analysis, RadicalCellsOfTwoSizesInTurnAreBoxesThatFillThePack) {
  constexpr double large = 1.5 * r, side = 0.065, h = 0.055;
  Lattice planes{.points = {}, .size = {7 * side, 7 * side, 10 * h}};
  for (int k = 0; k < 490; ++k) {
    planes.points.push_back({(k % 7 + 0.5) * side, (k / 7 % 7 + 0.5) * side, (k / 49 + 0.5) * h});
  }
  const auto radius_of = [](std::size_t k) { return k / 49 % 2 == 0 ? large : r; };
  const observe::Analysis a = of(planes, test::graded_input(3, 1.0, r, 1.5), 0.14, radius_of);
  const double shift = (large * large - r * r) / h;
  const auto share = [&](double radius, double height) {
    return 4.0 / 3.0 * std::numbers::pi * std::pow(radius, 3) / (side * side * height);
  };
  const double of_large = share(large, h + shift), of_small = share(r, h - shift);
  EXPECT_EQ(a.local.left_out, 0);
  EXPECT_EQ(a.local.counted, 6 * 49);
  EXPECT_NEAR(a.local.mean, 0.5 * (of_large + of_small), 1e-9);
  EXPECT_NEAR(a.local.sd, 0.5 * std::abs(of_large - of_small), 1e-9);
}

TEST_F(Analysis, SegregationIsPositiveWhereTheLargeOnesAreOnTop) {
  for (const double sign : {1.0, -1.0}) {
    const auto radius_of = [sign](std::size_t k) {  // not on a line: 20 planes of three spheres
      const double rise = static_cast<double>(k / 3) / 19.0 - 0.5;
      return r * (1.25 + 0.35 * sign * rise + 0.05 * static_cast<double>(k % 3));
    };
    Lattice tower{.points = {}, .size = {1.0, 1.0, 3.0}};
    for (std::size_t k = 0; k < 60; ++k) {
      tower.points.push_back({0.2 + 0.3 * static_cast<double>(k % 3), 0.5, 0.1 + 0.1 * static_cast<double>(k / 3)});
    }
    const observe::Analysis a = of(tower, test::graded_input(3, 1.0, r, 1.5), range, radius_of);
    double mean_r = 0.0, mean_z = 0.0, rr = 0.0, zz = 0.0, rz = 0.0;
    for (std::size_t k = 0; k < 60; ++k) mean_r += radius_of(k) / 60.0, mean_z += tower.points[k][2] / 60.0;
    for (std::size_t k = 0; k < 60; ++k) {
      const double dr = radius_of(k) - mean_r, dz = tower.points[k][2] - mean_z;
      rr += dr * dr, zz += dz * dz, rz += dr * dz;
    }
    EXPECT_NEAR(a.segregation.correlation, rz / std::sqrt(rr * zz), 1e-9);
    EXPECT_GT(sign * a.segregation.correlation, 0.5);
    const double width = 3.0 * 2.0 * 1.25 * r;  // 0.15: planes at 0.1; at 0.2 and none other; at 0.3, 0.4; ...
    EXPECT_NEAR(a.segregation.mean_radius.width, width, 1e-12);
    EXPECT_NEAR(a.segregation.mean_radius.values[0], (radius_of(0) + radius_of(1) + radius_of(2)) / 3.0, 1e-12);
    EXPECT_NEAR(a.segregation.mean_radius.values[1], (radius_of(3) + radius_of(4) + radius_of(5)) / 3.0, 1e-12);
  }
}

TEST_F(Analysis, HexagonalClosePacked) {
  const observe::Analysis a = of(hcp(), 3);
  EXPECT_NEAR(a.order.q4, 0.097222, 1e-4);
  EXPECT_NEAR(a.order.q6, 0.484762, 1e-4);
  EXPECT_EQ(a.order.fcc, 0.0);
  EXPECT_EQ(a.order.hcp, 1.0);
  EXPECT_NEAR(a.local.mean * std::pow(squeeze, 3), std::numbers::pi / std::sqrt(18.0), 1e-9);
}

// Whatever the size of particles: Voro++ alone takes corners nearer than some absolute length for one.
TEST_F(Analysis, CellsOfPowdersAreThoseOfPebbles) {
  for (const double scale : {1e-3, 1e-6}) {
    Lattice fine = hcp();
    for (Vec3& x : fine.points) {
      for (double& one : x) one *= scale;
    }
    for (double& one : fine.size) one *= scale;
    input::Input in = test::small_input(3, 1.0, scale * r);
    in.dynamics.time_step = 1e-12;
    const observe::Analysis a = of(fine, in, scale * range, [&](std::size_t) { return scale * r; });
    EXPECT_EQ(a.local.left_out, 0) << scale;
    EXPECT_NEAR(a.local.mean * std::pow(squeeze, 3), std::numbers::pi / std::sqrt(18.0), 1e-9) << scale;
  }
}

TEST_F(Analysis, SimpleCubic) {
  const observe::Analysis a = of(simple_cubic(), 3);
  EXPECT_NEAR(a.order.q4, 0.763763, 1e-5);
  EXPECT_NEAR(a.order.q6, 0.353553, 1e-5);
  EXPECT_EQ(a.order.fcc + a.order.hcp, 0.0);
  EXPECT_NEAR(a.local.mean * std::pow(squeeze, 3), std::numbers::pi / 6.0, 1e-9);
  EXPECT_NEAR(a.rest.network.coordination, 6.0 - 2.0 / 10.0, 1e-12);
  // The profile repeats from plane to plane, and its mean is the solid fraction.
  double mean = 0.0;
  for (std::size_t k = 0; k < 36; ++k) mean += a.density[2].values[k] / 36.0;
  EXPECT_NEAR(mean, std::numbers::pi / 6.0, 0.01);
  for (const double value : a.density[0].values) EXPECT_GT(value, 0.2);
}

TEST_F(Analysis, HexagonalDiscs) {
  const observe::Analysis a = of(hexagonal(), 2);
  EXPECT_NEAR(a.order.psi6, 1.0, 1e-9);
  EXPECT_NEAR(a.order.psi6_together, 1.0, 1e-9);
  EXPECT_NEAR(a.local.mean * std::pow(squeeze, 2), std::numbers::pi / std::sqrt(12.0), 1e-9);
  EXPECT_NEAR(a.rest.network.coordination, 6.0 - 4.0 * 16.0 / 288.0, 1e-12);
}

TEST_F(Analysis, SquareDiscs) {
  const observe::Analysis a = of(square(), 2);
  EXPECT_NEAR(a.order.psi6, 0.0, 1e-9);
  EXPECT_NEAR(a.local.mean * std::pow(squeeze, 2), std::numbers::pi / 4.0, 1e-9);
}

TEST_F(Analysis, RattlersAreReleasedOneAfterTheOther) {
  // Discs in a bridge: each leans on its two neighbours; the last has nothing at its other side.
  Lattice chain{.points = {}, .size = {1.0, 1.0, 0.0}};
  for (int k = 0; k < 8; ++k) chain.points.push_back({0.2 + squeeze * d * k, 0.5, 0.0});
  const observe::Analysis a = of(chain, 2);
  EXPECT_EQ(a.rest.network.loose, 2.0 / 8.0);
  EXPECT_EQ(a.rest.network.rattlers, 1.0);
  EXPECT_EQ(a.rest.network.held_coordination, 0.0);
}

std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(Analysis, ARunWritesItIfAskedTo) {
  const std::string text =
      "[container]\nsize = [0.3, 0.3, 0.1]\n"
      "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e8\npoisson_ratio = 0.25\n"
      "radius = { distribution = \"uniform\", min = 0.015, max = 0.02, weighting = \"number\" }\n"
      "[layers]\nthickness = 0.1\nfraction = 0.25\nduration = 0.02\nmaximum = 2\n[jamming]\ngravity = 2.0\n";
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("packmpi_analysis_" + std::to_string(::getppid()));
  const std::filesystem::path file = folder / "box.analysis.json";
  Options options;
  options.folder = folder.string();
  options.force = true;
  options.verbosity = log::Verbosity::quiet;
  if (comm_.rank() == 0) std::filesystem::remove_all(folder);
  comm_.barrier();
  (void)make_pack(comm_, scene::build(input::parse(text, "box.toml", {})), options);
  EXPECT_FALSE(std::filesystem::exists(file));
  comm_.barrier();
  (void)make_pack(comm_, scene::build(input::parse(text, "box.toml", {{"output.analysis=true"}})), options);
  const std::string written = contents(file);
  EXPECT_GT(written.size(), 1000U);
  comm_.barrier();
  (void)analyze(comm_, (folder / "box.hdf").string());
  EXPECT_EQ(written, contents(file));
  comm_.barrier();
  if (comm_.rank() == 0) std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace packmpi::run
