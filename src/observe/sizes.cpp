#include <algorithm>
#include <cmath>
#include <limits>

#include "comm/exact_sum.hpp"
#include "observe/measure.hpp"

namespace packmpi::observe {

SizeStatistics sizes(const comm::Comm& comm, const particles::Store& store) {
  const std::int64_t particles = comm.sum(std::int64_t{store.owned()});
  if (particles == 0) return {0.0, 0.0, 0.0, 0.0};
  comm::ExactSum radii;
  double smallest = std::numeric_limits<double>::infinity();
  double largest = 0.0;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    radii.add(store.radius(i));
    smallest = std::min(smallest, store.radius(i));
    largest = std::max(largest, store.radius(i));
  }
  smallest = comm.min(smallest);
  largest = comm.max(largest);
  if (smallest == largest) return {smallest, 0.0, smallest, largest};  // not the rounding of sum / count
  const auto count = static_cast<double>(particles);
  const double mean = comm::exact_sum(comm, radii) / count;
  comm::ExactSum squares;
  for (LocalIndex i = 0; i < store.owned(); ++i) squares.add((store.radius(i) - mean) * (store.radius(i) - mean));
  return {mean, std::sqrt(comm::exact_sum(comm, squares) / count), smallest, largest};
}

}  // namespace packmpi::observe
