#include "comm/door.hpp"
#include "output/late.hpp"
int main() { return mine(MPI_COMM_WORLD); }
