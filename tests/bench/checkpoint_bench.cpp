// What a checkpoint costs: mpirun -n N checkpoint_bench [particles = 1000000] [folder = .] [repeats = 7]
// Writes one of particles scattered over the ranks in an order that is not that of the ids, as in a run, and reads it
// back.
#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "comm/session.hpp"
#include "pack/checkpoint.hpp"

namespace {

using namespace packmpi;

// Every rank's share of `count` ids, in an order of its own.
particles::Store some_particles(const comm::Comm& comm, std::int64_t count) {
  particles::Store store(particles::layout_of(3, true));
  std::uint64_t draw = 1;
  const auto u = [&draw] {
    return static_cast<double>((draw = draw * 6364136223846793005u + 1442695040888963407u) >> 11) * 0x1p-53;
  };
  for (std::int64_t k = 0; k < count; ++k) {
    const std::int64_t id = k * 611953 % count;  // a prime
    if (id % comm.size() != comm.rank()) continue;
    store.add(id, {u(), u(), u()}, 0.01, {u(), u(), u()}, {u(), u(), u()});
  }
  return store;
}

void print(const char* what, std::vector<double> seconds, double megabytes) {
  std::sort(seconds.begin(), seconds.end());
  const double median = seconds[seconds.size() / 2];
  std::printf("%s: %.3f s (%.3f to %.3f), %.0f MB/s\n", what, median, seconds.front(), seconds.back(),
              megabytes / median);
}

}  // namespace

int main(int argc, char** argv) {
  const comm::Session session(argc, argv);
  const comm::Comm comm(MPI_COMM_WORLD);
  const std::int64_t count = argc > 1 ? std::atoll(argv[1]) : 1000000;
  const std::string path = std::string(argc > 2 ? argv[2] : ".") + "/checkpoint_bench.hdf";
  const int repeats = argc > 3 ? std::atoi(argv[3]) : 7;

  const particles::Store store = some_particles(comm, count);
  const std::array<const particles::Store*, 1> stores{&store};
  pack::RunState state;
  state.progress.count = count;
  state.effective_input = "seed = 1\n";
  std::vector<double> writing, reading;
  for (int k = 0; k < repeats; ++k) {
    comm.barrier();
    double start = MPI_Wtime();
    pack::write_checkpoint(comm, path, stores, state);
    writing.push_back(comm.max(MPI_Wtime() - start));
    start = MPI_Wtime();
    particles::Store back(store.layout());
    (void)pack::read_checkpoint(comm, path, back);
    reading.push_back(comm.max(MPI_Wtime() - start));
  }
  if (comm.rank() != 0) return 0;
  const double megabytes = static_cast<double>(std::filesystem::file_size(path)) * 1e-6;
  std::printf("%lld particles, %d ranks, %.0f MB\n", static_cast<long long>(count), comm.size(), megabytes);
  print("write", writing, megabytes);
  print("read and verify", reading, megabytes);
  std::filesystem::remove(path);
}
