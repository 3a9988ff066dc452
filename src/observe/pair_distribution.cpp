#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/container.hpp"
#include "observe/analysis.hpp"
#include "observe/measure.hpp"

namespace packmpi::observe {
namespace {

constexpr double bins_a_diameter = 50.0;

// The region in which every centre has its whole shell inside the pack.
struct Interior {
  std::array<double, 3> low{}, high{};
  geometry::Container box;  // round: at least `margin` from its side walls
  double margin = 0.0;
  [[nodiscard]] bool contains(const Vec3& x, int dimension) const {
    for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a) {
      if (!(x[a] >= low[a] && x[a] < high[a])) return false;
    }
    return box.holds(x, margin);
  }
  [[nodiscard]] double volume(int dimension) const {
    if (!box.is_box()) return box.volume_within(margin, low[dimension - 1], high[dimension - 1]);
    double v = 1.0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(dimension); ++a) v *= std::max(0.0, high[a] - low[a]);
    return v;
  }
};

Interior interior_of(const Specimen& pack, double range) {
  const geometry::Container& box = pack.scene.container;
  const auto v = static_cast<std::size_t>(box.vertical());
  Interior in{.box = box, .margin = range};
  for (std::size_t a = 0; a < static_cast<std::size_t>(box.lateral_axes()); ++a) {
    const double wall = box.periodic[a] || !box.is_box() ? 0.0 : range;
    in.low[a] = wall;
    in.high[a] = box.size[a] - wall;
  }
  in.low[v] = std::max(range, pack.bulk.low);
  in.high[v] = std::min(pack.surface - range, pack.bulk.high);
  return in;
}

double shell(int dimension, double inner, double outer) {
  constexpr double pi = std::numbers::pi;
  return dimension == 3 ? 4.0 / 3.0 * pi * (outer * outer * outer - inner * inner * inner)
                        : pi * (outer * outer - inner * inner);
}

}  // namespace

PairDistribution pair_distribution(const Specimen& pack) {
  const int dimension = pack.scene.container.dimension;
  const double diameter = 2.0 * pack.scene.sizes.mean();
  PairDistribution result;
  result.g.width = 1.0 / bins_a_diameter;
  const auto bins = static_cast<std::size_t>(std::floor(pack.range / diameter * bins_a_diameter));
  const Interior interior = interior_of(pack, pack.range);
  std::vector<std::int64_t> counts(bins + 1, 0);  // the last: centres
  const particles::Store& store = pack.store;
  for (LocalIndex i = 0; i < store.owned(); ++i)
    counts[bins] += interior.contains(store.position(i), dimension) ? 1 : 0;
  const neighbor::PairList& pairs = pack.neighborhood.near_pairs();
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    const LocalIndex i = pairs.first[p], j = pairs.second[p];
    const Vec3 xi = store.position(i), xj = store.position(j);
    const Vec3 d = geometry::separation(pack.scene.container, xi, xj);
    const double distance = std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    const auto bin = static_cast<std::size_t>(distance / diameter * bins_a_diameter);
    if (bin >= bins) continue;
    if (interior.contains(xi, dimension)) ++counts[bin];
    if (j < store.owned() && interior.contains(xj, dimension)) ++counts[bin];  // else its owner lists the pair, too
  }
  pack.comm.sum(std::span(counts));
  result.centres = counts[bins];
  if (result.centres == 0) return result;
  const auto centres = static_cast<double>(result.centres);
  const double density = centres / interior.volume(dimension);
  for (std::size_t k = 0; k < bins; ++k) {
    const double inner = static_cast<double>(k) / bins_a_diameter * diameter;
    const double expected = centres * density * shell(dimension, inner, inner + diameter / bins_a_diameter);
    result.g.values.push_back(static_cast<double>(counts[k]) / expected);
  }
  return result;
}

}  // namespace packmpi::observe
