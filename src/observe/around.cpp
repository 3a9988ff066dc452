#include "observe/around.hpp"

#include <algorithm>
#include <numeric>

#include "geometry/container.hpp"

namespace packmpi::observe {

Around::Around(const Specimen& pack, double factor) {
  const particles::Store& store = pack.store;
  const neighbor::PairList& pairs = pack.neighborhood.near_pairs();
  const auto near = [&](LocalIndex i, LocalIndex j) {
    const Vec3 d = geometry::separation(pack.scene.container, store.position(i), store.position(j));
    const double reach = std::min(pack.range, factor * (store.radius(i) + store.radius(j)));
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < reach * reach;
  };
  start_.assign(static_cast<std::size_t>(store.owned()) + 1, 0);
  std::vector<bool> wanted(pairs.first.size());
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    wanted[p] = near(pairs.first[p], pairs.second[p]);
    if (!wanted[p]) continue;
    ++start_[static_cast<std::size_t>(pairs.first[p]) + 1];
    if (pairs.second[p] < store.owned()) ++start_[static_cast<std::size_t>(pairs.second[p]) + 1];
  }
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  slots_.resize(start_.back());
  std::vector<std::size_t> next(start_.begin(), start_.end() - 1);
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    if (!wanted[p]) continue;
    const LocalIndex i = pairs.first[p], j = pairs.second[p];
    slots_[next[static_cast<std::size_t>(i)]++] = j;
    if (j < store.owned()) slots_[next[static_cast<std::size_t>(j)]++] = i;
  }
  const auto id = [&](LocalIndex slot) { return store.ids()[static_cast<std::size_t>(slot)]; };
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const auto begin = slots_.begin() + static_cast<std::ptrdiff_t>(start_[static_cast<std::size_t>(i)]);
    const auto end = slots_.begin() + static_cast<std::ptrdiff_t>(start_[static_cast<std::size_t>(i) + 1]);
    std::sort(begin, end, [&](LocalIndex a, LocalIndex b) { return id(a) < id(b); });
  }
}

}  // namespace packmpi::observe
