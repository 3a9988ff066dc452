// To be preloaded (scripts/study/halo.py): ghosts seem to travel for PACKMPI_FLIGHT seconds. A persistent request, as
// PetscSF makes them, does not end sooner than that after it was started. Both ends of a message start it at about the
// same time, so that is its flight. Reductions and parcels are as fast as they are.
#include <mpi.h>

#include <cstdlib>
#include <unordered_map>

namespace {

double flight() {
  static const double seconds = [] {
    const char* words = std::getenv("PACKMPI_FLIGHT");
    return words != nullptr ? std::atof(words) : 0.0;
  }();
  return seconds;
}

std::unordered_map<MPI_Request, double>& departures() {
  static std::unordered_map<MPI_Request, double> of_request;
  return of_request;
}

}  // namespace

extern "C" int MPI_Startall(int count, MPI_Request requests[]) {
  const double now = PMPI_Wtime();
  for (int k = 0; k < count; ++k) departures()[requests[k]] = now;
  return PMPI_Startall(count, requests);
}

extern "C" int MPI_Waitall(int count, MPI_Request requests[], MPI_Status statuses[]) {
  double last = 0.0;
  for (int k = 0; k < count; ++k) {
    const auto found = departures().find(requests[k]);
    if (found != departures().end() && found->second > last) last = found->second;
  }
  while (last > 0.0 && PMPI_Wtime() < last + flight()) {
  }
  return PMPI_Waitall(count, requests, statuses);
}
