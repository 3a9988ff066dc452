// main() of every test binary: MPI for the whole run, one printer, one verdict for all ranks.
#include <gtest/gtest.h>
#include <mpi.h>

#include "comm/session.hpp"

int main(int argc, char** argv) {
  const packmpi::comm::Session session(argc, argv);
  ::testing::InitGoogleTest(&argc, argv);
  int rank = 0;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  auto& listeners = ::testing::UnitTest::GetInstance()->listeners();
  if (rank != 0) delete listeners.Release(listeners.default_result_printer());
  const int mine = RUN_ALL_TESTS();
  int all = 0;
  MPI_Allreduce(&mine, &all, 1, MPI_INT, MPI_MAX, MPI_COMM_WORLD);
  return all;
}
