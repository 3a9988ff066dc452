// A program of somebody else's that uses the installed library: consumer SCENE.toml makes a small pack of it.
#include <mpi.h>

#include <iostream>
#include <packmpi/packmpi.hpp>

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  packmpi::PackOptions options;
  options.folder = "pack";
  options.set = {"layers.duration=0.01", "layers.maximum=1"};
  options.force = true;
  const packmpi::PackResult pack = packmpi::make_pack(MPI_COMM_WORLD, argc > 1 ? argv[1] : "", options);
  const packmpi::PackResult none = packmpi::make_pack(MPI_COMM_WORLD, "no-such-scene.toml", options);
  if (rank == 0) {
    std::cout << "packmpi " << packmpi::version() << " (" << packmpi::git_id() << ", " << packmpi::compiler() << ")\n"
              << pack.file << ": " << pack.particles << " particles, code " << pack.code << '\n'
              << "without a scene: code " << none.code << ", " << none.error << '\n';
  }
  MPI_Finalize();
  return 0;
}
