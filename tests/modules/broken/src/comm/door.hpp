#pragma once
#include <mpi.h>
#include <petscsf.h>

#include "base/early.hpp"
inline int mine(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}
