#include <algorithm>
#include <cmath>
#include <limits>

#include "observe/measure.hpp"

namespace packmpi::observe {

SizeStatistics sizes(const comm::Comm& comm, const particles::Store& store) {
  const std::int64_t particles = comm.sum(std::int64_t{store.owned()});
  if (particles == 0) return {0.0, 0.0, 0.0, 0.0};
  std::vector<double> terms;
  terms.reserve(static_cast<std::size_t>(store.owned()));
  double smallest = std::numeric_limits<double>::infinity();
  double largest = 0.0;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    terms.push_back(store.radius(i));
    smallest = std::min(smallest, terms.back());
    largest = std::max(largest, terms.back());
  }
  smallest = comm.min(smallest);
  largest = comm.max(largest);
  if (smallest == largest) return {smallest, 0.0, smallest, largest};  // not the rounding of sum / count
  const auto count = static_cast<double>(particles);
  const double mean = comm::exact_sum(comm, terms) / count;
  for (double& term : terms) term = (term - mean) * (term - mean);
  return {mean, std::sqrt(comm::exact_sum(comm, terms) / count), smallest, largest};
}

}  // namespace packmpi::observe
