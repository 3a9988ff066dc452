#include "rsa/placed.hpp"

#include <algorithm>
#include <cmath>

namespace packmpi::rsa {

void Placed::find_free(std::span<const Trial> trials, std::vector<char>& free) {
  constexpr std::size_t ahead = 16, block = 16;  // as many loads as are under way at once
  const auto nowhere = [](const Trial& trial) { return std::isnan(trial.sphere.centre[2]); };
  free.assign(trials.size(), 0);
  left_.clear();
  for (std::size_t k = 0; k < trials.size(); ++k) {
    if (k + ahead < trials.size() && !nowhere(trials[k + ahead])) excluded_.fetch(trials[k + ahead].sphere.centre);
    if (!nowhere(trials[k]) && !excluded_.holds(trials[k].sphere.centre))
      left_.push_back(static_cast<std::uint32_t>(k));
  }
  for (std::size_t k = 0; k < left_.size(); k += block) {
    find_free_of(trials, std::span(left_).subspan(k, std::min(block, left_.size() - k)), free);
  }
}

void Placed::find_free_of(std::span<const Trial> trials, std::span<const std::uint32_t> which,
                          std::vector<char>& free) const {
  for (const std::uint32_t k : which) bins_.fetch_cells(trials[k].sphere);
  for (const std::uint32_t k : which) bins_.fetch_spheres(trials[k].sphere);
  for (const std::uint32_t k : which) free[k] = bins_.overlaps(trials[k].sphere) ? 0 : 1;
}

}  // namespace packmpi::rsa
