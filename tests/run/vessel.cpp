// Vessels that are no box: what a particle feels of a round wall, what is measured in one, what holds a bed up.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "input/read.hpp"
#include "observe/measure.hpp"
#include "pack/pack.hpp"
#include "run/analyze.hpp"
#include "run/make_pack.hpp"
#include "support/placed_bed.hpp"

namespace packmpi::run {
namespace {

namespace fs = std::filesystem;
using test::Bench;

constexpr double pi = std::numbers::pi;

input::Input in_cylinder(input::Input in, double diameter, double height) {
  in.container.shape = input::VesselShape::cylinder;
  in.container.diameter = diameter;
  in.container.height = height;
  in.container.size = {diameter, diameter, height};
  return in;
}

double mass_of(double r) { return 1000.0 * 4.0 / 3.0 * pi * r * r * r; }

// Without friction, damping and gravity a sphere circles along the wall: the wall's force has no moment about the axis
// and does no work on the way round; it is that of the circle.
TEST(RoundWall, GuidesASphereAroundIt) {
  const comm::Comm comm(MPI_COMM_WORLD);
  const double r = 0.05, wall = 0.5, speed = 2.0;
  const double stiffness = 4.0 / 3.0 * 1e8 / (1.0 - 0.0625) * std::sqrt(r);  // of a rigid flat wall
  double depth = 0.0;  // where the circle's force is the contact's
  for (int turn = 0; turn < 50; ++turn) {
    depth = std::pow(mass_of(r) * speed * speed / (wall - r + depth) / stiffness, 2.0 / 3.0);
  }
  const double orbit = wall - r + depth;
  Bench bench(comm, in_cylinder(test::vacuum(3, 1.0, r, 1e-5, speed), 2.0 * wall, 1.0));
  bench.place({0.5 + orbit, 0.5, 0.5}, r, {0.0, speed, 0.0});
  bench.start();
  const double lap = 2.0 * pi * orbit / speed;
  bench.step(static_cast<std::int64_t>(std::llround(2.25 * lap / bench.dt())));
  const Bench::State at = bench.state(0);
  const double x = at.x[0] - 0.5, y = at.x[1] - 0.5;
  EXPECT_NEAR(x * at.v[1] - y * at.v[0], orbit * speed, 1e-9);
  EXPECT_NEAR(std::hypot(at.v[0], at.v[1]), speed, 1e-5);
  EXPECT_NEAR(std::hypot(x, y), orbit, 1e-6);
  EXPECT_NEAR(x, 0.0, 1e-3);  // a quarter past two laps
  EXPECT_NEAR(y, orbit, 1e-6);
  EXPECT_EQ(at.v[2], 0.0);
  EXPECT_EQ(at.omega, (Vec3{}));
}

// With friction it rolls: of a sphere that slides along the wall 5/7 of the speed is left at the point of the axis'
// distance R - r, as on a plane (its spin is about the vertical, whose direction does not turn).
TEST(RoundWall, LetsASphereRoll) {
  const comm::Comm comm(MPI_COMM_WORLD);
  for (const bool memory : {false, true}) {
    const double r = 0.05, speed = 2.0;
    input::Input in = in_cylinder(test::vacuum(3, 1.0, r, 1e-5, speed), 1.0, 1.0);
    in.contact.friction = in.contact.wall_friction = 0.3;
    if (memory) in.contact.tangential = input::Tangential::mindlin;
    Bench bench(comm, in);
    bench.place({0.95 + 1e-5, 0.5, 0.5}, r, {0.0, speed, 0.0});
    bench.start();
    bench.step(static_cast<std::int64_t>(1.5 / bench.dt()));
    const Bench::State at = bench.state(0);
    const double v = std::hypot(at.v[0], at.v[1]);
    EXPECT_NEAR(v, 5.0 / 7.0 * speed, 0.01) << memory;
    EXPECT_NEAR(std::abs(at.omega[2]) * r, v, 0.01) << memory;  // no slip
    EXPECT_NEAR(at.omega[0], 0.0, 1e-6);
    EXPECT_NEAR(at.v[2], 0.0, 1e-6);
  }
}

constexpr double diameter = 0.2, height = 0.22, density = 1000.0, gravity = 9.81;
constexpr const char* scene_text =
    "fidelity = \"balanced\"\n[container]\nshape = \"cylinder\"\ndiameter = 0.2\nheight = 0.22\n"
    "[particles]\ndensity = 1000.0\nyoungs_modulus = 1.0e7\npoisson_ratio = 0.25\n"
    "radius = { distribution = \"equal\", value = 0.01 }\n"
    "[layers]\nthickness = 0.11\nfraction = 0.25\n[jamming]\ngravity = 9.81\n"
    "[contact]\nfriction = 0.1\ndamping_ratio = 0.3\n[output]\ncontacts = true\n";

struct Made {
  report::RunRecord record;
  pack::PackRows rows;
  nlohmann::json analysis;
  double mantle_support = 0.0, floor_support = 0.0;  // [N] upward
};

// A bed ten diameters wide, made once for all tests. Collective.
const Made& made() {
  static const Made all = [] {
    const comm::Comm comm(MPI_COMM_WORLD);
    Options options;
    options.folder = fs::temp_directory_path() / ("packmpi_vessel_" + std::to_string(::getppid()));
    options.force = true;
    options.verbosity = log::Verbosity::quiet;
    Made m;
    input::Input in = input::parse(scene_text, "vessel.toml", {});
    m.record = make_pack(comm, scene::build(in), options);
    const std::string path = options.folder + "/vessel.hdf";
    m.rows = pack::read_pack(path);
    (void)analyze(comm, path);
    std::ifstream file(options.folder + "/vessel.analysis.json");
    m.analysis = nlohmann::json::parse(file);
    comm.barrier();
    if (comm.rank() == 0) fs::remove_all(options.folder);
    return m;
  }();
  return all;
}

TEST(CylinderBed, IsInsideAndAsHighAsAsked) {
  const Made& m = made();
  EXPECT_EQ(m.record.shape, "cylinder");
  EXPECT_GE(m.record.height, height);
  EXPECT_LT(m.record.height, height + 0.1);
  for (const Vec3& x : m.rows.position) {
    EXPECT_LT(std::hypot(x[0] - 0.5 * diameter, x[1] - 0.5 * diameter), 0.5 * diameter - 0.98 * 0.01);
  }
}

// Zou & Yu 1995: between their loose and their dense packing of spheres in cylinders.
TEST(CylinderBed, IsAsPorousAsBedsInCylindersAre) {
  const double ratio = 0.1;
  const double loose = 0.4 + 0.01 * (std::exp(10.686 * ratio) - 1.0);
  const double dense = 0.372 + 0.002 * (std::exp(15.306 * ratio) - 1.0);
  EXPECT_GT(1.0 - made().record.phi_bulk, dense);
  EXPECT_LT(1.0 - made().record.phi_bulk, loose);
}

TEST(CylinderBed, ItsShellsAddUpToItsBulk) {
  const Made& m = made();
  const nlohmann::json& profile = m.analysis["radial_profile"]["from_wall"];
  const double width = profile["width"];
  const std::vector<double> values = profile["values"];
  double solid = 0.0, area = 0.0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    const double outer = 0.5 * diameter - width * static_cast<double>(k);
    const double inner = std::max(0.0, outer - width);
    solid += values[k] * pi * (outer * outer - inner * inner);
    area += pi * (outer * outer - inner * inner);
  }
  EXPECT_NEAR(area, 0.25 * pi * diameter * diameter, 1e-12);
  EXPECT_NEAR(solid / area, m.record.phi_bulk, 2e-5);  // spheres that are pressed into the wall are cut there
  EXPECT_LT(values[0], 0.2);                           // a sphere touches in a point
  EXPECT_GT(values[9], 0.7);                           // half a diameter from the wall
  EXPECT_LT(values[20], 0.62);                         // one
}

// Caps by another formula, summed in another precision and order.
TEST(CylinderBed, ItsSolidFractionIsThatOfItsSpheresCutByPlanes) {
  const Made& m = made();
  long double solid = 0.0L;
  for (std::size_t k = m.rows.id.size(); k-- > 0;) {
    const long double r = m.rows.radius[k], z = m.rows.position[k][2];
    const long double low = std::clamp(m.record.bulk.low - z, -r, r), high = std::clamp(m.record.bulk.high - z, -r, r);
    const auto below = [&](long double h) { return pi * (r * r * h - h * h * h / 3.0L); };  // above the centre
    solid += below(high) - below(low);
  }
  const double volume = pi * 0.25 * diameter * diameter * (m.record.bulk.high - m.record.bulk.low);
  EXPECT_GT(m.record.bulk.high, m.record.bulk.low);
  EXPECT_NEAR(m.record.phi_bulk, static_cast<double>(solid) / volume, 1e-9);
}

// De Klerk's core: as dense as a bed without walls.
TEST(CylinderBed, IsInItsMiddleAsDenseAsABedWithoutWalls) {
  const double core = made().analysis["radial_profile"]["core"]["solid_fraction"];
  EXPECT_GT(core, made().record.phi_bulk);
  EXPECT_NEAR(core, 0.62, 0.02);
}

// What floor and mantle bear is the weight: rows of /wall_contacts, by the definition.
TEST(CylinderBed, FloorAndWallBearItsWeight) {
  const Made& m = made();
  EXPECT_GT(m.record.floor_force, 0.5 * m.record.weight);
  EXPECT_LT(m.record.floor_force, 1.1 * m.record.weight);  // a bed that hardens rises, and the wall holds it down
  EXPECT_NEAR(m.record.rest.support, 1.0, 0.02);
}

// Janssen: of a column h high the floor bears the share (1 - exp(-x)) / x of the weight, x = 4 mu K h / D, with a ratio
// of stresses K below 1; less than that of active beds where not all friction of the wall is used.
TEST(CylinderColumn, StandsOnItsWallMoreThanOnItsFloor) {
  const comm::Comm comm(MPI_COMM_WORLD);
  Options options;
  options.folder = fs::temp_directory_path() / ("packmpi_column_" + std::to_string(::getppid()));
  options.force = true;
  options.verbosity = log::Verbosity::quiet;
  const double friction = 0.2, wide = 0.08;
  const input::Overrides narrow{.set = {"container.diameter=0.08", "container.height=0.6", "contact.friction=0.2"}};
  const report::RunRecord record =
      make_pack(comm, scene::build(input::parse(scene_text, "column.toml", narrow)), options);
  comm.barrier();
  if (comm.rank() == 0) fs::remove_all(options.folder);
  const auto share = [&](double k) {
    const double x = 4.0 * friction * k * record.height / wide;
    return (1.0 - std::exp(-x)) / x;
  };
  EXPECT_LT(record.floor_force / record.weight, share(0.2));
  EXPECT_GT(record.floor_force / record.weight, share(0.7));
  EXPECT_NEAR(record.rest.support, 1.0, 0.02);
}

}  // namespace
}  // namespace packmpi::run
