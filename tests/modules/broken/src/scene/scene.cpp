#include <Random123/philox.h>
#include <metis.h>
#include <petscdmda.h>

#include <Eigen/Dense>

#include "attic/box.hpp"
#include "comm/door.hpp"
#include "output/late.hpp"
const char* text = "MPI_Barrier(MPI_COMM_WORLD) in words is allowed";
int everybody() { return mine(MPI_COMM_WORLD); }  // MPI_Barrier(comm) in a comment is, too
double now() { return MPI_Wtime(); }
void wait(MPI_Comm comm /* MPI_Comm_rank(x) */) { PMPI_Barrier(comm); }
