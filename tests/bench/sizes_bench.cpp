// sizes_bench [particles = 60000] [ratio ...]: one rank. Two radii, half of the mass each, 1:ratio, settled in one
// periodic layer; then the same bed with cells of one size and with a search by size class: pairs looked at and listed
// a particle, time of a rebuild, particle-steps a second of the whole loop. Default ratios 1 2 5 10 20.
#include <fmt/core.h>
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "comm/session.hpp"
#include "rsa/insert.hpp"
#include "run/bed.hpp"
#include "support/scenes.hpp"

namespace packmpi {
namespace {

constexpr double small = 0.001;               // [m]
constexpr std::int64_t falling_steps = 4000;  // most have landed

input::Input layer_of(double particles, double ratio) {
  const double large = small * ratio;
  const double volume = 4.0 / 3.0 * 3.14159265 * small * small * small * particles * (ratio > 1.0 ? 2.0 : 1.0) / 0.25;
  const double side = std::max(7.0 * large, std::cbrt(volume));
  input::Input in = test::periodic(test::small_input(3, side, small));
  in.container.size = {side, side, side};
  in.layers.thickness = std::max(2.5 * large, volume / (side * side));
  in.layers.fraction = 0.25;
  in.layers.attempts = 1000000;
  in.layers.velocity = {0.0, 0.0, -0.3};
  in.jamming.gravity = 9.81;
  in.particles.youngs_modulus = 5e7;
  in.contact.damping_ratio = 0.5;
  in.dynamics.time_step.reset();
  if (ratio > 1.0) {
    in.particles.radius.distribution = input::SizeDistribution::bidisperse;
    in.particles.radius.weighting = input::Weighting::mass;
    in.particles.radius.small = small;
    in.particles.radius.large = large;
    in.particles.radius.large_share = 0.5;
  }
  return in;
}

void measure(const scene::Scene& scene, const comm::Comm& comm, const particles::Store& particles, const char* name) {
  run::Bed bed(comm, scene);
  for (LocalIndex i = 0; i < particles.owned(); ++i)
    bed.store.add_record(particles.ids()[static_cast<std::size_t>(i)], particles.record(i));
  bed.neighborhood.rebuild(bed.store);
  constexpr int builds = 3, steps = 200;
  double best = HUGE_VAL;
  for (int k = 0; k < builds; ++k) {
    const double start = MPI_Wtime();
    bed.neighborhood.rebuild(bed.store);
    best = std::min(best, MPI_Wtime() - start);
  }
  const auto n = static_cast<double>(particles.owned());
  const double looked = static_cast<double>(bed.neighborhood.candidates()) / n;
  const double listed = static_cast<double>(bed.neighborhood.pairs().first.size()) / n;
  const double start = MPI_Wtime();
  bed.stepper.advance(bed.store, bed.neighborhood, steps);
  const double rate = n * steps / (MPI_Wtime() - start);
  fmt::print("| 1:{:g} | {} | {} | {:.1f} | {:.2f} | {:.0f} | {:.2f} | {:.0f} | {} |\n", scene.sizes.ratio(),
             particles.owned(), name, looked, listed, 1e9 * best / n, 1e-6 * rate, bed.bytes_per_particle(),
             bed.neighborhood.pairs().window);
}

void compare(const comm::Comm& comm, double particles, double ratio) {
  const scene::Scene scene = scene::build(layer_of(particles, ratio));
  run::Bed bed(comm, scene);
  (void)rsa::insert(comm, scene, bed.ownership, {0, 0.0, scene.in.layers.thickness, 0}, bed.store);
  bed.neighborhood.rebuild(bed.store);
  bed.stepper.advance(bed.store, bed.neighborhood, falling_steps);
  scene::Scene one_size = scene;
  one_size.features.size_levels = 1;
  one_size.skin = 0.1 * scene.sizes.largest();
  scene::Scene same_skin = one_size;
  same_skin.skin = scene.skin;
  scene::Scene by_size = scene;
  by_size.features.size_levels = std::max(2, static_cast<int>(std::log2(ratio)) + 1);
  measure(one_size, comm, bed.store, "cells of one size, skin 0.1 r_max");
  if (ratio > 1.0) measure(same_skin, comm, bed.store, "cells of one size, skin 0.2 r_mean");
  if (ratio > 1.0) measure(by_size, comm, bed.store, "by size class");
}

}  // namespace
}  // namespace packmpi

int main(int argc, char** argv) {
  const packmpi::comm::Session session(argc, argv);
  const packmpi::comm::Comm comm(MPI_COMM_WORLD);
  const double particles = argc > 1 ? std::atof(argv[1]) : 60000.0;
  std::vector<double> ratios{1.0, 2.0, 5.0, 10.0, 20.0};
  if (argc > 2) ratios.clear();
  for (int k = 2; k < argc; ++k) ratios.push_back(std::atof(argv[k]));
  fmt::print(
      "| radii | particles | search | candidates | listed pairs | rebuild, ns a particle | 1e6 particle-steps/s | "
      "bytes a particle | window |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|\n");
  for (const double ratio : ratios) packmpi::compare(comm, particles, ratio);
  return 0;
}
