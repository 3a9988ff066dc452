#include <algorithm>
#include <array>
#include <vector>

#include "comm/exact_sum.hpp"
#include "observe/measure.hpp"
#include "observe/touch.hpp"

namespace packmpi::observe {
namespace {

/// Sums of this rank over the pairs it counts.
struct PairSums {
  comm::ExactSum overlaps;  // over the smaller radius
  std::int64_t counted = 0;
  double largest = 0.0;
  std::int64_t ends = 0;  // owned ends of touching pairs
};

/// Each touching pair adds one to both its ends that are owned here. A pair across a border is listed on both ranks,
/// and one of them counts it in the sums.
PairSums count_pairs(const particles::Store& store, const geometry::Container& box, const neighbor::PairList& pairs,
                     GlobalId frozen_below, std::vector<std::int32_t>& of_particle) {
  PairSums sums;
  each_touching(store, box, pairs, [&](std::int64_t, LocalIndex i, LocalIndex j, double overlap) {
    ++of_particle[static_cast<std::size_t>(i)];
    const bool both_owned = j < store.owned();
    if (both_owned) ++of_particle[static_cast<std::size_t>(j)];
    sums.ends += both_owned ? 2 : 1;
    if (is_counted_here(store, i, j, frozen_below)) {
      const double relative = overlap / std::min(store.radius(i), store.radius(j));
      sums.overlaps.add(relative);
      ++sums.counted;
      sums.largest = std::max(sums.largest, relative);
    }
  });
  return sums;
}

}  // namespace

Contacts contacts(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                  const neighbor::PairList& pairs, const neighbor::WallList& walls, GlobalId frozen_below) {
  Contacts result;
  result.of_particle.assign(static_cast<std::size_t>(store.owned()), 0);
  const PairSums sums = count_pairs(store, scene.container, pairs, frozen_below, result.of_particle);

  double deepest = 0.0;
  each_touching_wall(store, scene.container, walls,
                     [&](std::int64_t, LocalIndex i, neighbor::Wall, const geometry::Facing& at) {
                       deepest = std::max(deepest, (store.radius(i) - at.distance) / store.radius(i));
                     });
  std::array<std::int64_t, 3> counts{std::int64_t{store.owned()}, sums.counted, sums.ends};
  comm.sum(counts);
  std::array<double, 2> maxima{sums.largest, deepest};
  comm.max(maxima);
  const double total_overlap = comm::exact_sum(comm, sums.overlaps);
  const auto particles = static_cast<double>(std::max<std::int64_t>(counts[0], 1));
  result.pairs = counts[1];
  result.pairs_here = sums.counted;
  result.coordination = static_cast<double>(counts[2]) / particles;
  result.mean_overlap = counts[1] > 0 ? total_overlap / static_cast<double>(counts[1]) : 0.0;
  result.max_overlap = maxima[0];
  result.max_wall_penetration = maxima[1];
  return result;
}

}  // namespace packmpi::observe
