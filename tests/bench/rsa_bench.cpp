// Spheres placed a second, from the seed to the last sphere: mpirun -n N rsa_bench [spheres = 100000] [fraction = 0.25]
// [repeats = 5]
#include <mpi.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "comm/session.hpp"
#include "rsa/insert.hpp"
#include "support/rsa_scenes.hpp"

int main(int argc, char** argv) {
  using namespace packmpi;
  const comm::Session session(argc, argv);
  const comm::Comm comm(MPI_COMM_WORLD);
  const double spheres = argc > 1 ? std::atof(argv[1]) : 1e5;
  const double fraction = argc > 2 ? std::atof(argv[2]) : 0.25;
  const int repeats = argc > 3 ? std::atoi(argv[3]) : 5;

  const double thickness = 0.2;
  const double radius = std::cbrt(fraction * thickness / spheres / 4.18879);
  double best = 1e300;
  for (int k = 0; k < repeats; ++k) {
    const auto seed = static_cast<std::uint64_t>(k + 1);
    const scene::Scene scene =
        test::rsa_scene(3, {1.0, 1.0, 1.0}, {true, true}, test::equal_radius(radius), fraction, 1000000, seed);
    comm.barrier();
    const double start = MPI_Wtime();
    const scene::Ownership ownership(comm, test::rsa_grid(scene), input::Decomposition::slab);
    particles::Store store(scene.features.layout());
    const rsa::Insertion got = rsa::insert(comm, scene, ownership, {0, 0.0, thickness, 0}, store);
    const double seconds = comm.max(MPI_Wtime() - start);
    best = std::min(best, seconds);
    if (comm.rank() == 0) {
      std::printf("%lld spheres, %lld trials, %.3f s: %.3g spheres/s, %.3g a rank\n",
                  static_cast<long long>(got.inserted), static_cast<long long>(got.trials), seconds,
                  static_cast<double>(got.inserted) / seconds,
                  static_cast<double>(got.inserted) / seconds / comm.size());
    }
  }
  if (comm.rank() == 0) std::printf("best %.3f s on %d ranks\n", best, comm.size());
}
