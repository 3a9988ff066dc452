#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <voro++/voro++.hh>

#include "comm/exact_sum.hpp"
#include "geometry/container.hpp"
#include "geometry/volume.hpp"
#include "observe/around.hpp"

namespace packmpi::observe {
namespace {

// Voro++ takes corners nearer than an absolute length for one: lengths are measured in about a mean diameter, and in a
// power of two, which changes no digit. [m]
double unit_of(const scene::Scene& scene) { return std::ldexp(1.0, std::ilogb(2.0 * scene.sizes.mean())); }

// A round wall near x, as planes that touch it.
void cut_by_walls(const geometry::Container& box, const Vec3& x, double range, double unit, voro::voronoicell& cell) {
  if (box.is_box()) return;
  box.touching_planes(x, range, [&](const Vec3& n, double away) { cell.plane(n[0], n[1], n[2], 2.0 * away / unit); });
}

// Volume of the cell of particle i over unit^3, 2D: unit^2; none if particles beyond the range might cut it.
std::optional<double> cell_volume(const Specimen& pack, LocalIndex i, std::span<const LocalIndex> neighbours,
                                  double unit) {
  const geometry::Container& box = pack.scene.container;
  const bool plane = box.dimension == 2;
  const Vec3 x = pack.store.position(i);
  const double r = pack.store.radius(i) / unit, range = pack.range / unit;
  std::array<double, 3> low{-0.5, -0.5, -0.5}, high{0.5, 0.5, 0.5};  // 2D: a slab of unit thickness
  for (std::size_t a = 0; a < static_cast<std::size_t>(box.dimension); ++a) {
    const bool vertical = a == static_cast<std::size_t>(box.vertical());
    const bool open = !vertical && box.periodic[a];
    low[a] = open ? -range : std::max(-range, -x[a] / unit);
    high[a] = open || vertical ? range : std::min(range, (box.size[a] - x[a]) / unit);
  }
  voro::voronoicell cell;
  cell.init(low[0], high[0], low[1], high[1], low[2], high[2]);
  cut_by_walls(box, x, pack.range, unit, cell);
  for (const LocalIndex j : neighbours) {
    Vec3 d = geometry::separation(box, x, pack.store.position(j));
    for (double& along : d) along /= unit;
    const double rj = pack.store.radius(j) / unit;
    const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    if (!cell.plane(d[0], d[1], d[2], square + r * r - rj * rj)) return std::nullopt;  // swallowed by a larger one
  }
  double farthest = 0.25 * cell.max_radius_squared();  // Voro++ keeps its vertices doubled
  if (plane) farthest -= 0.25;                         // the corners are half a unit above and below
  // A particle farther than this cuts nothing; radical planes move by the difference of squared radii.
  const double largest = pack.scene.sizes.largest() / unit;
  const double reach = std::sqrt(farthest) + std::sqrt(std::max(0.0, farthest - r * r + largest * largest));
  if (reach > range) return std::nullopt;
  return cell.volume();
}

}  // namespace

LocalDensity local_density(const Specimen& pack) {
  constexpr double width = 0.01;
  const double unit = unit_of(pack.scene);
  const Around around(pack, std::numeric_limits<double>::infinity());
  const auto vertical = static_cast<std::size_t>(pack.scene.container.vertical());
  std::array<comm::ExactSum, 2> terms;
  std::int64_t counted = 0;
  std::vector<std::int64_t> counts(102, 0);  // bins of width, then left out
  for (LocalIndex i = 0; i < pack.store.owned(); ++i) {
    if (!pack.bulk.has(pack.store.position(i)[vertical])) continue;
    const std::optional<double> cell = cell_volume(pack, i, around.of(i), unit);
    if (!cell) {
      ++counts.back();
      continue;
    }
    const double share = geometry::volume(pack.scene.container.dimension, pack.store.radius(i) / unit) / *cell;
    ++counted;
    terms[0].add(share);
    terms[1].add(share * share);
    ++counts[static_cast<std::size_t>(std::clamp(share / width, 0.0, 100.0))];
  }
  const std::vector<double> sums = comm::exact_sums(pack.comm, terms);
  LocalDensity result;
  result.counted = pack.comm.sum(counted);
  pack.comm.sum(std::span(counts));
  result.left_out = counts.back();
  result.distribution.width = width;
  if (result.counted == 0) return result;
  const auto n = static_cast<double>(result.counted);
  result.mean = sums[0] / n;
  result.sd = std::sqrt(std::max(0.0, sums[1] / n - result.mean * result.mean));
  for (std::size_t k = 0; k < 101; ++k)
    result.distribution.values.push_back(static_cast<double>(counts[k]) / (n * width));
  return result;
}

}  // namespace packmpi::observe
