// mpirun -n N bed_bench [particles = 107000] [steps = 300] [runs = 5] [rotation = 1] [sd = 0] [data file or -] [law]
//
// The whole step loop (kernel, walls, ghosts, rebuild tests, rebuilds) on a settled bed of the paper's spheres
// (example 5.3's material, r = 0.02 m, dt = 1e-4 s): a small periodic brick is packed and settled, tiled sideways
// between walls to about the asked number, and advanced. Prints particle-steps a second and core, median and spread
// over the runs, and bytes a particle on the worst rank. With a data file (one rank), the bed is also written there as
// LAMMPS and LIGGGHTS read it, as it stands when the counting begins (scripts/study/compare.py). `sd` is the standard
// deviation of Gaussian radii about 0.02 m, as a share of it, cut off at three of them (0: equal radii). `law` is that
// of the friction: sliding, mindlin or rolling (mindlin with resistance to rolling and twisting).
#include <fmt/core.h>
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>

#include "comm/session.hpp"
#include "observe/measure.hpp"
#include "rsa/insert.hpp"
#include "run/bed.hpp"
#include "support/scenes.hpp"

namespace packmpi {
namespace {

constexpr double radius = 0.02;     // [m]
constexpr double brick_side = 0.5;  // [m] of the settled brick
constexpr int brick_layers = 12;

input::Input material(double side, bool rotation, double sd, const std::string& law) {
  input::Input in = test::small_input(3, side, radius);
  if (sd > 0.0) {
    in.particles.radius.distribution = input::SizeDistribution::gaussian;
    in.particles.radius.mean = radius;
    in.particles.radius.sd = radius * sd;
    in.particles.radius.min = radius * (1.0 - 3.0 * sd);
    in.particles.radius.max = radius * (1.0 + 3.0 * sd);
  }
  in.container.size = {side, side, 0.5};
  in.layers.thickness = 0.1;
  in.layers.fraction = 0.24;
  in.layers.attempts = 100000;
  in.drag.coefficient = 0.005;
  in.dynamics.rotation = rotation;
  if (law != "sliding") in.contact.tangential = input::Tangential::mindlin;
  if (law == "rolling") in.contact.rolling_friction = in.contact.twisting_friction = 0.1;
  in.dynamics.time_step = 1e-4;
  return in;
}

// One particle of the brick.
struct Grain {
  Vec3 x;
  double r;
};

// The settled brick on every rank (each packs its own: a serial communicator).
std::vector<Grain> settled_brick(const input::Input& in) {
  const comm::Comm self(MPI_COMM_SELF);
  const scene::Scene scene = scene::build(in);
  run::Bed bed(self, scene);
  for (int layer = 0; layer < brick_layers; ++layer) {
    bed.store.set_ghosts(0);
    const rsa::LayerRegion region{static_cast<std::uint32_t>(layer), observe::top(self, bed.store, scene),
                                  in.layers.thickness, bed.progress.count};
    bed.progress.count += rsa::insert(self, scene, bed.ownership, region, bed.store).inserted;
    bed.neighborhood.rebuild(bed.store);
    bed.stepper.advance(bed.store, bed.neighborhood, 6000);
  }
  std::vector<Grain> grains;
  for (LocalIndex i = 0; i < bed.store.owned(); ++i) grains.push_back({bed.store.position(i), bed.store.radius(i)});
  return grains;
}

// Tiles the brick over the columns of this rank, without what would stand in the side walls.
void lay_out(run::Bed& bed, const std::vector<Grain>& brick, int tiles) {
  const double side = brick_side * tiles;
  GlobalId id = 0;
  for (int tile = 0; tile < tiles * tiles; ++tile) {
    for (const Grain& grain : brick) {
      const Vec3 x{grain.x[0] + brick_side * (tile % tiles), grain.x[1] + brick_side * (tile / tiles), grain.x[2]};
      if (std::min(x[0], x[1]) < grain.r || std::max(x[0], x[1]) > side - grain.r) continue;
      if (bed.ownership.owner(bed.ownership.grid().column(x)) == bed.comm.rank()) {
        bed.store.add(id, x, grain.r, {}, {});
      }
      ++id;
    }
  }
  bed.progress.count = id;
  bed.neighborhood.rebuild(bed.store);
}

// The bed as a LAMMPS data file of style sphere.
void write_data(const run::Bed& bed, const char* path) {
  std::ofstream out(path);
  const double side = bed.scene.container.size[0];
  out << "bed of packmpi: units si\n\n" << bed.progress.count << " atoms\n1 atom types\n\n";
  out << fmt::format("-0.005 {0} xlo xhi\n-0.005 {0} ylo yhi\n-0.005 0.8 zlo zhi\n\nAtoms\n\n", side + 0.005);
  for (LocalIndex i = 0; i < bed.store.owned(); ++i) {
    const Vec3 x = bed.store.position(i);
    out << fmt::format("{} 1 {:.17g} 1000 {:.17g} {:.17g} {:.17g}\n", bed.store.ids()[static_cast<std::size_t>(i)] + 1,
                       2.0 * bed.store.radius(i), x[0], x[1], x[2]);
  }
}

// The ledger of a row of the step log, in steps; looked at at the default interval it must not show.
double ledger_in_steps(const run::Bed& bed, double steps_per_second) {
  std::vector<double> seconds;
  for (int k = 0; k < 5; ++k) {
    const double start = MPI_Wtime();
    (void)observe::ledger(bed.comm, bed.store, bed.scene, bed.stepper.law(), bed.neighborhood);
    seconds.push_back(bed.comm.max(MPI_Wtime() - start));
  }
  return *std::ranges::min_element(seconds) * steps_per_second;
}

void measure(run::Bed& bed, std::int64_t steps, int runs) {
  std::vector<double> rates, costs;
  const double rebuilding = bed.neighborhood.effort().rebuilding;
  const std::int64_t rebuilds = bed.neighborhood.rebuilds();
  for (int k = 0; k < runs; ++k) {
    bed.comm.barrier();
    const double start = MPI_Wtime();
    const std::clock_t begin = std::clock();
    bed.stepper.advance(bed.store, bed.neighborhood, steps);
    costs.push_back(bed.comm.max(static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC));
    const double seconds = bed.comm.max(MPI_Wtime() - start);
    rates.push_back(static_cast<double>(bed.progress.count) * static_cast<double>(steps) / seconds / bed.comm.size());
  }
  std::ranges::sort(rates);
  std::ranges::sort(costs);
  const double share = static_cast<double>(steps) * static_cast<double>(bed.progress.count) / bed.comm.size();
  const observe::Contacts contacts =
      observe::contacts(bed.comm, bed.store, bed.scene, bed.neighborhood.pairs(), bed.neighborhood.walls());
  const double bytes = bed.bytes_per_particle();
  const double median = rates[rates.size() / 2];
  const double row = ledger_in_steps(bed, median * bed.comm.size() / static_cast<double>(bed.progress.count));
  if (bed.comm.rank() != 0) return;
  fmt::print(
      "{} particles on {} ranks ({}), coordination {:.2f}, {:.2f} listed pairs a particle, {} rebuilds in {} steps\n",
      bed.progress.count, bed.comm.size(), dynamics::kernel_architecture(), contacts.coordination,
      static_cast<double>(bed.neighborhood.pairs().first.size()) / bed.store.owned(),
      bed.neighborhood.rebuilds() - rebuilds, steps * runs);
  fmt::print("particle-steps/s a core: median {:.2f}e6, least {:.2f}e6, most {:.2f}e6; {:.0f} bytes a particle\n",
             median * 1e-6, rates.front() * 1e-6, rates.back() * 1e-6, bytes);
  fmt::print(
      "processor time: median {:.1f} ns a particle-step, least {:.1f}, most {:.1f}; {:.0f} ns wall time a particle and "
      "rebuild\n",
      1e9 * costs[costs.size() / 2] / share, 1e9 * costs.front() / share, 1e9 * costs.back() / share,
      1e9 * (bed.neighborhood.effort().rebuilding - rebuilding) /
          static_cast<double>(std::max<std::int64_t>(bed.neighborhood.rebuilds() - rebuilds, 1)) /
          static_cast<double>(bed.store.owned()));
  fmt::print("the ledger of a row of the step log costs {:.2f} steps\n", row);
}

}  // namespace
}  // namespace packmpi

int main(int argc, char** argv) {
  using namespace packmpi;
  const comm::Session session(argc, argv);
  const comm::Comm comm(MPI_COMM_WORLD);
  const double particles = argc > 1 ? std::atof(argv[1]) : 107000.0;
  const auto steps = static_cast<std::int64_t>(argc > 2 ? std::atof(argv[2]) : 300.0);
  const int runs = argc > 3 ? std::atoi(argv[3]) : 5;
  const bool rotation = argc > 4 ? std::atoi(argv[4]) != 0 : true;
  const double sd = argc > 5 ? std::atof(argv[5]) : 0.0;
  const std::string law = argc > 7 ? argv[7] : "sliding";
  const std::vector<Grain> brick = settled_brick(test::periodic(material(brick_side, rotation, sd, law)));
  const int tiles =
      std::max(1, static_cast<int>(std::lround(std::sqrt(particles / static_cast<double>(brick.size())))));
  const scene::Scene scene = scene::build(material(brick_side * tiles, rotation, sd, law));
  run::Bed bed(comm, scene);
  lay_out(bed, brick, tiles);
  bed.stepper.advance(bed.store, bed.neighborhood, 1000);  // small tiles' seams and the first rebuilds
  if (argc > 6 && std::string(argv[6]) != "-" && comm.size() == 1) write_data(bed, argv[6]);
  measure(bed, steps, runs);
  return 0;
}
