#include "observe/measure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "support/scattered.hpp"

namespace packmpi::observe {
namespace {

using testing::every_spread;
using testing::Grain;
using testing::Spread;

constexpr double pi = std::numbers::pi;

class Observe : public ::testing::Test {
 protected:
  comm::Comm comm_{MPI_COMM_WORLD};

  [[nodiscard]] particles::Store store(const std::vector<Grain>& grains, const scene::Scene& scene,
                                       Spread spread) const {
    return testing::scattered(comm_, scene.features.layout(), grains, spread);
  }
};

/// n^3 equal spheres on a simple cubic lattice, the first at half a spacing from the lower corner.
std::vector<Grain> cubic(int n, double spacing, double r) {
  std::vector<Grain> grains;
  for (int k = 0; k < n; ++k) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i)
        grains.push_back({{(i + 0.5) * spacing, (j + 0.5) * spacing, (k + 0.5) * spacing}, r});
    }
  }
  return grains;
}

std::vector<Grain> random_grains(int dimension, std::size_t count, const Vec3& size) {
  testing::Scatter u;
  std::vector<Grain> grains(count);
  for (Grain& g : grains) {
    g.r = 0.02 + 0.03 * u();
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(dimension); ++axis) {
      g.x[axis] = u() * size[axis];
      g.v[axis] = u() - 0.5;
    }
    g.w = dimension == 3 ? Vec3{u(), u(), u()} : Vec3{0.0, 0.0, u()};
  }
  return grains;
}

/// The definition, one column at a time.
double slow_surface(const std::vector<Grain>& grains, const geometry::Container& box, double largest) {
  const int nx = std::max(1, static_cast<int>(box.size[0] / (2.0 * largest)));
  const int ny = box.dimension == 3 ? std::max(1, static_cast<int>(box.size[1] / (2.0 * largest))) : 1;
  long double sum = 0.0L;
  for (int iy = 0; iy < ny; ++iy) {
    for (int ix = 0; ix < nx; ++ix) {
      double highest = 0.0;
      for (const Grain& g : grains) {
        const bool in_x = std::min(nx - 1, static_cast<int>(g.x[0] / box.size[0] * nx)) == ix;
        const bool in_y = box.dimension == 2 || std::min(ny - 1, static_cast<int>(g.x[1] / box.size[1] * ny)) == iy;
        if (in_x && in_y) highest = std::max(highest, g.x[static_cast<std::size_t>(box.vertical())] + g.r);
      }
      sum += static_cast<long double>(highest);
    }
  }
  return static_cast<double>(sum / (static_cast<long double>(nx) * ny));
}

// The corners of the square around a cylinder are no part of its surface, and neither is what columns at its wall have
// outside.
TEST_F(Observe, SurfaceOfALevelBedInACylinderIsItsTop) {
  auto scene = testing::make_scene(3, {1.0, 1.0, 0.5}, {false, false}, 0.1);
  scene.container.shape = geometry::Shape::cylinder;
  std::vector<Grain> grains;
  for (int i = 0; i < 200; ++i) {
    for (int k = 0; k < 200; ++k) {
      const Vec3 x{(i + 0.5) / 200.0, (k + 0.5) / 200.0, 0.2};
      if (std::hypot(x[0] - 0.5, x[1] - 0.5) <= 0.402) grains.push_back({x, 0.1});
    }
  }
  for (const Spread spread : every_spread) {
    const auto placed = store(grains, scene, spread);
    EXPECT_NEAR(surface_height(comm_, placed, scene), 0.3, 1e-12);
    EXPECT_NEAR(surface_height(comm_, placed, scene, 0), 0.3, 1e-12);  // by mail
  }
}

TEST_F(Observe, DensityInACylinderIsThatOfItsRoom) {
  auto scene = testing::make_scene(3, {1.0, 1.0, 1.0}, {false, false}, 0.1);
  scene.container.shape = geometry::Shape::cylinder;
  const auto placed = store({{{0.5, 0.2, 0.5}, 0.1}, {{0.5, 0.5, 1.0}, 0.1}}, scene, every_spread[0]);
  const Density got = density(comm_, placed, scene, {0.2, 0.8});
  const double sphere = 4.0 / 3.0 * pi * 1e-3, floor = 0.25 * pi;
  EXPECT_NEAR(got.phi, 1.5 * sphere / floor, 1e-15);
  EXPECT_NEAR(got.phi_bulk, sphere / (0.6 * floor), 1e-15);
}

TEST_F(Observe, SurfaceIsTheMeanOfTheColumnMaxima) {
  const auto flat = testing::make_scene(2, {0.55, 1.0, 0.0}, {false, false}, 0.05);   // 5 columns: fewer than 8 ranks
  const auto solid = testing::make_scene(3, {0.35, 0.25, 1.0}, {false, true}, 0.05);  // 3 x 2 columns
  const auto wide = testing::make_scene(3, {2.0, 1.3, 0.4}, {true, false}, 0.05);     // 20 x 13, some of them empty
  for (const auto& scene : {flat, solid, wide}) {
    for (const std::size_t count : {0u, 3u, 60u, 400u}) {
      const auto grains = random_grains(scene.container.dimension, count, scene.container.size);
      const double expected = slow_surface(grains, scene.container, 0.05);
      const double reference = surface_height(comm_, store(grains, scene, Spread::last), scene);
      EXPECT_NEAR(reference, expected, 4e-16 * expected);
      for (const Spread spread : every_spread) {
        EXPECT_EQ(surface_height(comm_, store(grains, scene, spread), scene), reference);
        EXPECT_EQ(surface_height(comm_, store(grains, scene, spread), scene, 0), reference);  // nothing stored
      }
    }
  }
}

TEST_F(Observe, SurfaceTakesBordersAndStrangersIntoTheEndColumns) {
  const auto scene = testing::make_scene(2, {0.5, 1.0, 0.0}, {false, false}, 0.05);  // 5 columns
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Grain> grains{{{0.5, 0.3, 0.0}, 0.05}, {{-0.01, 0.2, 0.0}, 0.05}, {{nan, nan, 0.0}, 0.05}};
  EXPECT_DOUBLE_EQ(surface_height(comm_, store(grains, scene, Spread::all), scene), (0.35 + 0.25) / 5.0);
}

TEST_F(Observe, TopIsTheHighestPoint) {
  const auto scene = testing::make_scene(3, {1.0, 1.0, 1.0}, {false, false}, 0.3);
  const std::vector<Grain> grains{{{0.5, 0.5, 0.70}, 0.1}, {{0.1, 0.9, 0.55}, 0.3}, {{0.1, 0.1, 0.1}, 0.05}};
  for (const Spread spread : every_spread) EXPECT_EQ(top(comm_, store(grains, scene, spread), scene), 0.55 + 0.3);
  EXPECT_EQ(top(comm_, store({}, scene, Spread::all), scene), 0.0);
}

TEST_F(Observe, DensityCountsWhatIsBelowThePlanes) {
  const auto scene = testing::make_scene(3, {1.0, 2.0, 1.0}, {false, false}, 0.1);
  const double ball = 4.0 / 3.0 * pi * 1e-3;
  const std::vector<Grain> grains{{{0.5, 0.5, 1.0}, 0.1},    // half below H_d
                                  {{0.5, 1.5, 0.5}, 0.1},    // whole, in the bulk
                                  {{0.2, 0.5, 0.8}, 0.1},    // whole, half in the bulk
                                  {{0.2, 1.5, 0.2}, 0.1},    // whole, half in the bulk
                                  {{0.2, 0.2, 0.05}, 0.05},  // whole, below the bulk
                                  {{0.2, 0.9, 1.2}, 0.1}};   // above
  const Density first =
      density(comm_, store(grains, scene, Spread::last), scene, bulk_of(scene, scene.container.height()));
  EXPECT_NEAR(first.phi, (0.5 + 3.0 + 0.125) * ball / 2.0, 1e-15);
  EXPECT_NEAR(first.phi_bulk, 2.0 * ball / (2.0 * 0.6), 1e-15);
  for (const Spread spread : every_spread) {
    const Density again = density(comm_, store(grains, scene, spread), scene, bulk_of(scene, scene.container.height()));
    EXPECT_EQ(again.phi, first.phi);
    EXPECT_EQ(again.phi_bulk, first.phi_bulk);
  }
}

TEST_F(Observe, TheBulkOfALowBedIsItsOwn) {
  const auto scene = testing::make_scene(3, {1.0, 2.0, 1.0}, {false, false}, 0.1);
  EXPECT_EQ(bulk_of(scene, 7.0).high, 0.8);
  EXPECT_EQ(bulk_of(scene, 0.8).high, 0.8);
  const Bulk bulk = bulk_of(scene, 0.5);
  EXPECT_DOUBLE_EQ(bulk.low, 0.1);
  EXPECT_DOUBLE_EQ(bulk.depth(), 0.3);
  EXPECT_TRUE(bulk.has(0.1));
  EXPECT_FALSE(bulk.has(0.41));
  const double ball = 4.0 / 3.0 * pi * 1e-3;
  const std::vector<Grain> grains{{{0.5, 0.5, 0.4}, 0.1}, {{0.5, 1.5, 0.2}, 0.1}};  // half of one, all of the other
  const Density got = density(comm_, store(grains, scene, Spread::all), scene, bulk);
  EXPECT_NEAR(got.phi_bulk, 1.5 * ball / (2.0 * 0.3), 1e-15);
  EXPECT_NEAR(got.phi, 2.0 * ball / 2.0, 1e-15);
}

TEST_F(Observe, DensityOfALatticeOfDiscs) {
  const auto scene = testing::make_scene(2, {1.0, 0.5, 0.0}, {true, false}, 0.05);
  std::vector<Grain> grains;
  for (int j = 0; j < 6; ++j) {  // the sixth row is above H_d
    for (int i = 0; i < 10; ++i) grains.push_back({{0.05 + 0.1 * i, 0.05 + 0.1 * j, 0.0}, 0.05});
  }
  const Density got =
      density(comm_, store(grains, scene, Spread::all), scene, bulk_of(scene, scene.container.height()));
  EXPECT_NEAR(got.phi, pi / 4.0, 1e-14);
  EXPECT_NEAR(got.phi_bulk, pi / 4.0, 1e-14);
}

TEST_F(Observe, MotionByHand) {
  const auto scene = testing::make_scene(3, {1.0, 1.0, 1.0}, {false, false}, 0.1);
  const std::vector<Grain> grains{{{0.5, 0.5, 0.25}, 0.1, {3.0, 0.0, -4.0}, {0.0, 0.0, 0.0}},
                                  {{0.5, 0.5, 0.50}, 0.05, {0.0, 1.0, 0.0}, {10.0, 0.0, 20.0}},
                                  {{0.5, 0.2, 0.75}, 0.05, {}, {}}};
  const double m0 = 1000.0 * 4.0 / 3.0 * pi * 1e-3;
  const double m1 = m0 / 8.0;
  const double spin_energy = 0.5 * (0.4 * m1 * 0.05 * 0.05) * 500.0;
  const Motion first = motion(comm_, store(grains, scene, Spread::last), scene);
  EXPECT_NEAR(first.kinetic_energy, 0.5 * m0 * 25.0 + 0.5 * m1 + spin_energy, 1e-12);
  EXPECT_DOUBLE_EQ(first.max_speed, 5.0);
  EXPECT_DOUBLE_EQ(first.mean_height, 0.5);
  EXPECT_NEAR(first.mass, m0 + 2.0 * m1, 1e-14);
  for (const Spread spread : every_spread) {
    const Motion again = motion(comm_, store(grains, scene, spread), scene);
    EXPECT_EQ(again.kinetic_energy, first.kinetic_energy);
    EXPECT_EQ(again.mass, first.mass);
  }
}

TEST_F(Observe, DiscsHaveTheMassAndSpinOfSpheres) {
  auto scene = testing::make_scene(2, {1.0, 1.0, 0.0}, {false, false}, 0.1);
  const std::vector<Grain> grains{{{0.5, 0.25, 0.0}, 0.1, {0.0, 2.0, 0.0}, {0.0, 0.0, 30.0}}};
  const double m = 1000.0 * 4.0 / 3.0 * pi * 1e-3;
  const Motion got = motion(comm_, store(grains, scene, Spread::all), scene);
  EXPECT_NEAR(got.kinetic_energy, 0.5 * m * 4.0 + 0.2 * m * 0.01 * 900.0, 1e-12);
  EXPECT_EQ(got.mean_height, 0.25);
  scene.features.rotation = false;
  EXPECT_NEAR(motion(comm_, store(grains, scene, Spread::all), scene).kinetic_energy, 0.5 * m * 4.0, 1e-12);
}

TEST_F(Observe, MotionOfNothing) {
  const auto scene = testing::make_scene(3, {1.0, 1.0, 1.0}, {false, false}, 0.1);
  const Motion got = motion(comm_, store({}, scene, Spread::all), scene);
  EXPECT_EQ(got.kinetic_energy, 0.0);
  EXPECT_EQ(got.mean_height, 0.0);
  EXPECT_EQ(density(comm_, store({}, scene, Spread::all), scene, bulk_of(scene, 0.0)).phi, 0.0);
}

struct LatticeCase {
  std::array<bool, 2> periodic;
  double side;  // of the box; 0.4: the lattice touches the walls
  std::int64_t pairs;
};

TEST_F(Observe, ContactsOfASimpleCubicLattice) {
  constexpr double spacing = 0.1;
  constexpr double r = 0.0505;  // overlap 0.001
  const auto grains = cubic(4, spacing, r);
  const LatticeCase cases[] = {
      {{false, false}, 0.4, 144}, {{true, true}, 0.4, 176}, {{true, false}, 0.4, 160}, {{false, false}, 0.9, 144}};
  for (const LatticeCase& c : cases) {
    auto shifted = grains;
    if (c.side > 0.4) {
      for (Grain& g : shifted) g.x = {g.x[0] + 0.2, g.x[1] + 0.2, g.x[2]};
    }
    const auto scene = testing::make_scene(3, {c.side, c.side, 0.4}, c.periodic, r);
    for (const Spread spread : every_spread) {
      const auto s = store(shifted, scene, spread);
      const Contacts got = contacts(comm_, s, scene, testing::all_pairs(s), testing::all_walls(s, scene.container));
      EXPECT_EQ(got.pairs, c.pairs);
      EXPECT_DOUBLE_EQ(got.coordination, 2.0 * static_cast<double>(c.pairs) / 64.0);
      EXPECT_NEAR(got.mean_overlap, 0.001 / r, 1e-14);
      EXPECT_NEAR(got.max_overlap, 0.001 / r, 1e-14);
      EXPECT_NEAR(got.max_wall_penetration, 0.0005 / r, 1e-14);
      std::int64_t ends = 0;
      for (const std::int32_t n : got.of_particle) ends += n;
      EXPECT_EQ(comm_.sum(ends), 2 * c.pairs);
      ASSERT_EQ(got.of_particle.size(), static_cast<std::size_t>(s.owned()));
    }
  }
}

TEST_F(Observe, ContactsOfRandomSpheresDoNotDependOnTheRanks) {
  const auto scene = testing::make_scene(3, {0.5, 0.4, 0.3}, {true, false}, 0.05);
  const auto grains = random_grains(3, 120, scene.container.size);
  std::map<GlobalId, std::int32_t> slow;  // by the definition
  std::int64_t pairs = 0;
  for (std::size_t i = 0; i < grains.size(); ++i) {
    for (std::size_t j = 0; j < grains.size(); ++j) {
      double dx = std::abs(grains[i].x[0] - grains[j].x[0]);
      dx = std::min(dx, 0.5 - dx);
      const double d = std::hypot(dx, grains[i].x[1] - grains[j].x[1], grains[i].x[2] - grains[j].x[2]);
      if (i == j || d >= grains[i].r + grains[j].r) continue;
      ++slow[static_cast<GlobalId>(i)];
      pairs += i < j ? 1 : 0;
    }
  }
  ASSERT_GT(pairs, 50);
  const auto one = store(grains, scene, Spread::last);
  const Contacts first = contacts(comm_, one, scene, testing::all_pairs(one), testing::all_walls(one, scene.container));
  for (const Spread spread : every_spread) {
    const auto s = store(grains, scene, spread);
    const Contacts got = contacts(comm_, s, scene, testing::all_pairs(s), testing::all_walls(s, scene.container));
    EXPECT_EQ(got.pairs, pairs);
    EXPECT_EQ(got.mean_overlap, first.mean_overlap);
    EXPECT_EQ(got.max_overlap, first.max_overlap);
    EXPECT_EQ(got.max_wall_penetration, first.max_wall_penetration);
    for (LocalIndex i = 0; i < s.owned(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      EXPECT_EQ(got.of_particle[k], slow[s.ids()[k]]);
    }
  }
}

TEST_F(Observe, SizesByHand) {
  const auto scene = testing::make_scene(3, {1.0, 1.0, 1.0}, {false, false}, 0.1);
  const std::vector<Grain> grains{{{}, 0.01}, {{}, 0.02}, {{}, 0.03}, {{}, 0.04}};
  for (const Spread spread : every_spread) {
    const SizeStatistics got = sizes(comm_, store(grains, scene, spread));
    EXPECT_DOUBLE_EQ(got.mean, 0.025);
    EXPECT_NEAR(got.sd, std::sqrt(1.25e-4), 1e-16);
    EXPECT_EQ(got.min, 0.01);
    EXPECT_EQ(got.max, 0.04);
  }
  const SizeStatistics equal = sizes(comm_, store(cubic(3, 0.1, 0.02), scene, Spread::all));
  EXPECT_EQ(equal.mean, 0.02);
  EXPECT_EQ(equal.sd, 0.0);
  EXPECT_EQ(sizes(comm_, store({}, scene, Spread::all)).max, 0.0);
}

TEST_F(Observe, ValidityFindsTheLostAndTheBroken) {
  const auto scene = testing::make_scene(3, {1.0, 1.0, 1.0}, {false, true}, 0.1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const std::vector<Grain> grains{{{0.5, 0.5, 2.0}, 0.1},               // above: open at the top
                                  {{-1e-9, 0.5, 0.5}, 0.1},             // outside
                                  {{0.5, 1.1, 0.5}, 0.1},               // outside: not wrapped
                                  {{0.5, 0.5, -0.1}, 0.1},              // outside
                                  {{0.5, 0.5, 0.5}, 0.1, {0, nan, 0}},  // broken
                                  {{0.5, 0.5, 0.5}, 0.1, {}, {inf, 0, 0}},
                                  {{nan, 0.5, 0.5}, 0.1}};
  for (const Spread spread : every_spread) {
    const Validity got = validity(comm_, store(grains, scene, spread), scene);
    EXPECT_EQ(got.found, 7);
    EXPECT_EQ(got.outside, 3);
    EXPECT_EQ(got.non_finite, 3);
  }
}

constexpr double reduced_modulus = 1.0e8 / (2.0 * (1.0 - 0.0625));

TEST_F(Observe, ForceOfAPairAtRestIsHertz) {
  const auto scene = testing::make_scene(3, {1.0, 1.0, 1.0}, {true, false}, 0.1);
  const double overlap = 1e-4;  // through the periodic face
  const std::vector<Grain> grains{
      {{0.05, 0.5, 0.5}, 0.1}, {{0.05 + 1.0 - 0.2 + overlap, 0.5, 0.5}, 0.1}, {{0.5, 0.5, 0.5}, 0.1}};
  for (const Spread spread : every_spread) {
    const auto s = store(grains, scene, spread);
    const auto rows = contact_forces(s, scene, testing::all_pairs(s));
    EXPECT_EQ(comm_.sum(static_cast<std::int64_t>(rows.size())), 1);
    for (const ContactForce& row : rows) {
      EXPECT_EQ(row.first, 0);
      EXPECT_EQ(row.second, 1);
      EXPECT_NEAR(row.overlap, overlap, 1e-15);
      const double hertz = 4.0 / 3.0 * std::sqrt(0.05) * reduced_modulus * std::pow(overlap, 1.5);
      EXPECT_NEAR(row.force[0], hertz, 1e-10 * hertz);  // 1 is to the left of 0 through the face
      EXPECT_EQ(row.force[1], 0.0);
      EXPECT_EQ(row.force[2], 0.0);
      EXPECT_FALSE(std::signbit(row.force[1]) || std::signbit(row.force[2])) << "whichever end the list has first";
    }
  }
}

TEST_F(Observe, ForceOfASlidingPairIsCoulombs) {
  const auto scene = testing::make_scene(3, {1.0, 1.0, 1.0}, {false, false}, 0.1);
  const double overlap = 1e-4;
  // 1 is above 0, moves away along x, towards it along -z, and spins about y so that the slip doubles.
  const std::vector<Grain> grains{{{0.5, 0.5, 0.5}, 0.1},
                                  {{0.5, 0.5, 0.7 - overlap}, 0.1, {1.0, 0.0, -0.01}, {0.0, -10.0, 0.0}}};
  const auto s = store(grains, scene, Spread::all);
  const double mass = 1000.0 * 4.0 / 3.0 * pi * 1e-3 / 2.0;  // reduced
  const double elastic = 4.0 / 3.0 * std::sqrt(0.05) * reduced_modulus * std::pow(overlap, 1.5);
  const double damping =
      2.0 * 0.1 * std::sqrt(2.0 * std::sqrt(0.05) * reduced_modulus * mass) * std::pow(overlap, 0.25);
  const double normal = elastic + damping * 0.01;
  const auto rows = contact_forces(s, scene, testing::all_pairs(s));
  ASSERT_EQ(comm_.sum(static_cast<std::int64_t>(rows.size())), 1);
  for (const ContactForce& row : rows) {
    EXPECT_NEAR(row.force[2], -normal, 1e-9 * normal);
    EXPECT_NEAR(row.force[0], 0.2 * normal, 1e-9 * normal);
    EXPECT_NEAR(row.force[1], 0.0, 1e-9 * normal);
  }
  // The same spin the other way round stops the slip: v_x + omega x (-r n) = 0, and friction with it.
  auto rolling = grains;
  rolling[1].w = {0.0, 10.0, 0.0};
  const auto t = store(rolling, scene, Spread::all);
  for (const ContactForce& row : contact_forces(t, scene, testing::all_pairs(t)))
    EXPECT_NEAR(row.force[0], 0.0, 1e-9 * normal);
}

TEST_F(Observe, FrictionIsCappedAtTheForceThatStopsTheSlip) {
  const auto scene = testing::make_scene(3, {1.0, 1.0, 1.0}, {false, false}, 0.1);
  const double slip = 1e-7;
  const std::vector<Grain> grains{{{0.5, 0.5, 0.5}, 0.1}, {{0.5, 0.5, 0.69}, 0.1, {slip, 0.0, 0.0}}};
  const auto s = store(grains, scene, Spread::all);
  const double mass = 1000.0 * 4.0 / 3.0 * pi * 1e-3 / 2.0;
  const double stopping = 2.0 / 7.0 * mass * slip / scene.time_step;
  const auto rows = contact_forces(s, scene, testing::all_pairs(s));
  ASSERT_EQ(comm_.sum(static_cast<std::int64_t>(rows.size())), 1);
  for (const ContactForce& row : rows) {
    EXPECT_NEAR(row.force[0], stopping, 1e-9 * stopping);
  }
}

TEST_F(Observe, FloorForceAtRestIsTheWeight) {
  const auto scene = testing::make_scene(3, {1.0, 1.0, 1.0}, {false, false}, 0.1);
  const double weight = 1000.0 * 4.0 / 3.0 * pi * 1e-3 * 2.0;  // rigid floor: E* = 2 reduced_modulus, r* = r
  const double depth = std::pow(weight / (4.0 / 3.0 * 2.0 * reduced_modulus * std::sqrt(0.1)), 2.0 / 3.0);
  std::vector<Grain> grains;
  for (int k = 0; k < 5; ++k) grains.push_back({{0.1 + 0.2 * k, 0.5, 0.1 - depth}, 0.1});
  grains.push_back({{0.5, 0.9, 0.3}, 0.1});  // in the air
  for (const Spread spread : every_spread) {
    const auto s = store(grains, scene, spread);
    EXPECT_NEAR(floor_force(comm_, s, scene, testing::all_walls(s, scene.container)), 5.0 * weight, 1e-9 * weight);
  }
}

TEST_F(Observe, ForcesOfRandomDiscsDoNotDependOnTheRanks) {
  const auto scene = testing::make_scene(2, {0.6, 0.5, 0.0}, {true, false}, 0.05);
  const auto grains = random_grains(2, 80, scene.container.size);
  std::map<std::pair<GlobalId, GlobalId>, ContactForce> known;  // every rank: all owned here
  {
    particles::Store all(scene.features.layout());
    for (std::size_t k = 0; k < grains.size(); ++k)
      all.add(static_cast<GlobalId>(k), grains[k].x, grains[k].r, grains[k].v, grains[k].w);
    for (const ContactForce& row : contact_forces(all, scene, testing::all_pairs(all)))
      known[{row.first, row.second}] = row;
  }
  ASSERT_GT(known.size(), 30u);
  for (const Spread spread : every_spread) {
    const auto s = store(grains, scene, spread);
    const auto rows = contact_forces(s, scene, testing::all_pairs(s));
    EXPECT_EQ(comm_.sum(static_cast<std::int64_t>(rows.size())), static_cast<std::int64_t>(known.size()));
    for (const ContactForce& row : rows) {
      ASSERT_LT(row.first, row.second);
      const ContactForce& same = known.at({row.first, row.second});
      EXPECT_EQ(row.overlap, same.overlap);
      EXPECT_EQ(row.force, same.force);
    }
  }
}

}  // namespace
}  // namespace packmpi::observe
