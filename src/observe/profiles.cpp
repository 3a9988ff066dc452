#include <algorithm>
#include <cmath>
#include <limits>

#include "comm/exact_sum.hpp"
#include "geometry/volume.hpp"
#include "observe/analysis.hpp"
#include "observe/measure.hpp"

namespace packmpi::observe {
namespace {

constexpr double slabs_a_diameter = 4.0;
constexpr double diameters_a_layer = 3.0;
constexpr std::size_t most_slabs = 1 << 16;  // of a profile; wider ones where more would be needed

std::size_t bins_in(double length, double width) {
  return static_cast<std::size_t>(std::max(1.0, std::ceil(length / width - 1e-9)));
}

}  // namespace

Profile density_profile(const Specimen& pack, int axis) {
  const geometry::Container& box = pack.scene.container;
  const auto a = static_cast<std::size_t>(axis);
  const bool vertical = axis == box.vertical();
  const double length = vertical ? top(pack.comm, pack.store, pack.scene) : box.size[a];
  const double width = 2.0 * pack.scene.sizes.mean() / slabs_a_diameter;
  const std::size_t slabs = std::min(bins_in(length, width), most_slabs);
  const bool as_wide = vertical && slabs < most_slabs;  // a bed ends where it ends, a box with a slab
  Profile profile{.from = 0.0, .width = as_wide ? width : length / static_cast<double>(slabs), .values = {}};
  const std::size_t bins = bins_in(length, profile.width);
  std::vector<comm::ExactSum> terms(bins);
  for (LocalIndex i = 0; i < pack.store.owned(); ++i) {
    const Vec3 x = pack.store.position(i);
    const double r = pack.store.radius(i);
    if (!vertical && !pack.bulk.has(x[static_cast<std::size_t>(box.vertical())])) continue;
    const auto first = static_cast<std::ptrdiff_t>(std::floor((x[a] - r) / profile.width));
    const auto last = static_cast<std::ptrdiff_t>(std::floor((x[a] + r) / profile.width));
    const auto n = static_cast<std::ptrdiff_t>(bins);
    for (std::ptrdiff_t k = first; k <= last; ++k) {
      const bool beyond = k < 0 || k >= n;
      if (beyond && (vertical || !box.periodic[a])) continue;  // inside a wall
      const double low = static_cast<double>(k) * profile.width;
      const double slice = geometry::volume_below(box.dimension, r, x[a], low + profile.width) -
                           geometry::volume_below(box.dimension, r, x[a], low);
      terms[static_cast<std::size_t>((k + n) % n)].add(slice);
    }
  }
  profile.values = comm::exact_sums(pack.comm, terms);
  if (!box.is_box() && !(vertical && box.straight())) {
    for (std::size_t k = 0; k < bins; ++k) {
      const double low = static_cast<double>(k) * profile.width, high = low + profile.width;
      const double volume =
          vertical ? box.volume_between(low, high) : box.slab(a, low, high, pack.bulk.low, pack.bulk.high);
      profile.values[k] = volume > 0.0 ? profile.values[k] / volume : 0.0;
    }
    return profile;
  }
  const double section = vertical ? box.mean_area() : box.mean_area() / box.size[a] * pack.bulk.depth();
  for (double& value : profile.values) value /= section * profile.width;
  return profile;
}

Segregation segregation(const Specimen& pack) {
  const auto vertical = static_cast<std::size_t>(pack.scene.container.vertical());
  const double width = diameters_a_layer * 2.0 * pack.scene.sizes.mean();
  Segregation result;
  const std::size_t bins = std::min(bins_in(top(pack.comm, pack.store, pack.scene), width), most_slabs);
  std::vector<comm::ExactSum> radii(bins);
  std::vector<std::int64_t> counts(bins, 0);
  std::vector<comm::ExactSum> moments(5);  // r, z, r r, z z, r z
  for (LocalIndex i = 0; i < pack.store.owned(); ++i) {
    const double z = pack.store.position(i)[vertical];
    const double r = pack.store.radius(i);
    const auto k = static_cast<std::size_t>(std::clamp(z / width, 0.0, static_cast<double>(bins) - 0.5));
    radii[k].add(r);
    ++counts[k];
    const std::array<double, 5> terms{r, z, r * r, z * z, r * z};
    for (std::size_t m = 0; m < terms.size(); ++m) moments[m].add(terms[m]);
  }
  result.mean_radius = {.from = 0.0, .width = width, .values = comm::exact_sums(pack.comm, radii)};
  pack.comm.sum(std::span(counts));
  for (std::size_t k = 0; k < bins; ++k) {
    double& mean = result.mean_radius.values[k];
    mean = counts[k] > 0 ? mean / static_cast<double>(counts[k]) : std::numeric_limits<double>::quiet_NaN();
  }
  const std::vector<double> m = comm::exact_sums(pack.comm, moments);
  const auto n = static_cast<double>(std::max<std::int64_t>(1, pack.comm.sum(std::int64_t{pack.store.owned()})));
  const double spread = (m[2] - m[0] * m[0] / n) * (m[3] - m[1] * m[1] / n);
  if (pack.scene.features.graded && spread > 0.0) result.correlation = (m[4] - m[0] * m[1] / n) / std::sqrt(spread);
  return result;
}

}  // namespace packmpi::observe
