#include "observe/composition.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/elementary.hpp"
#include "scene/mixture.hpp"

namespace packmpi::observe {
namespace {

std::size_t component_at(const particles::Store& store, LocalIndex i) {
  return static_cast<std::size_t>(scene::component_of(store.substance(i).code));
}

std::int64_t cut_units(const scene::Scene& scene, double radius, double centre, double height) {
  return std::llrint(geometry::volume_below(3, radius, centre, height) / scene::volume_unit(scene));
}

// Sums by component and by slab of height.
struct Heights {
  Heights(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene, double width, double top)
      : components(scene.in.components.size()), slabs(static_cast<std::size_t>(std::max(1.0, std::ceil(top / width)))) {
    const auto up = static_cast<std::size_t>(scene.container.vertical());
    units.assign(slabs * components, 0);
    for (LocalIndex i = 0; i < store.owned(); ++i) {
      const double at = std::clamp(std::floor(store.position(i)[up] / width), 0.0, static_cast<double>(slabs - 1));
      units[static_cast<std::size_t>(at) * components + component_at(store, i)] +=
          scene::volume_units(scene, store.radius(i));
    }
    comm.sum(std::span(units));
  }
  [[nodiscard]] std::int64_t of_slab(std::size_t slab) const {
    std::int64_t sum = 0;
    for (std::size_t c = 0; c < components; ++c) sum += units[slab * components + c];
    return sum;
  }
  std::size_t components, slabs;
  std::vector<std::int64_t> units;
};

void add_parts(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene, Composition& found) {
  const std::size_t components = scene.in.components.size();
  std::vector<std::int64_t> sums(2 * components, 0);  // counts, then units
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const std::size_t c = component_at(store, i);
    ++sums[c];
    sums[components + c] += scene::volume_units(scene, store.radius(i));
  }
  comm.sum(std::span(sums));
  for (std::size_t c = 0; c < components; ++c) {
    const input::Component& of = scene.in.components[c];
    const double volume = static_cast<double>(sums[components + c]) * scene::volume_unit(scene);
    found.parts.push_back({of.name, sums[c], volume, volume * of.particles.density});
  }
}

// Cells of about so many particles, and no more cells than that.
constexpr double particles_a_cell = 40.0;
constexpr double most_cells = 4096.0;

void add_lacey(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene, const Bulk& bulk,
               Composition& found) {
  const auto up = static_cast<std::size_t>(scene.container.vertical());
  const double depth = bulk.high - bulk.low;
  std::array<std::int64_t, 1> inside{0};
  const auto is_inside = [&](LocalIndex i) {
    const double z = store.position(i)[up];
    return z >= bulk.low && z < bulk.high;
  };
  for (LocalIndex i = 0; i < store.owned(); ++i) inside[0] += is_inside(i) ? 1 : 0;
  comm.sum(std::span(inside));
  if (!(depth > 0.0) || inside[0] < 4 * static_cast<std::int64_t>(particles_a_cell)) {
    for (ComponentPart& part : found.parts) part.lacey = part.lacey_error = std::numeric_limits<double>::quiet_NaN();
    return;
  }
  const double wanted = std::clamp(static_cast<double>(inside[0]) / particles_a_cell, 4.0, most_cells);
  const double cells = scene.container.volume_between(bulk.low, bulk.high) / wanted;
  // Two cells at least above each other: what is apart lies so.
  const double high = std::min(up == 2 ? elementary::cube_root(cells) : std::sqrt(cells), 0.5 * depth);
  const double wide = up == 2 ? std::sqrt(cells / high) : cells / high;
  std::array<std::size_t, 3> counts{1, 1, 1};
  std::array<double, 3> widths{1.0, 1.0, 1.0};
  for (std::size_t a = 0; a <= up; ++a) {
    const double extent = a == up ? depth : scene.container.size[a];
    counts[a] = static_cast<std::size_t>(std::max(1.0, std::floor(extent / (a == up ? high : wide))));
    widths[a] = extent / static_cast<double>(counts[a]);
  }
  const std::size_t all = counts[0] * counts[1] * counts[2], components = found.parts.size();
  std::vector<std::int64_t> numbers(all * (components + 1), 0);  // of all, then of each component
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    if (!is_inside(i)) continue;
    const Vec3 x = store.position(i);
    std::size_t cell = 0;
    for (std::size_t a = up + 1; a-- > 0;) {
      const double from = a == up ? bulk.low : 0.0;
      const double at = std::clamp(std::floor((x[a] - from) / widths[a]), 0.0, static_cast<double>(counts[a] - 1));
      cell = cell * counts[a] + static_cast<std::size_t>(at);
    }
    ++numbers[cell];
    ++numbers[(component_at(store, i) + 1) * all + cell];
  }
  comm.sum(std::span(numbers));
  found.cells = static_cast<std::int64_t>(all);
  found.cell = widths[up];
  const auto row = [&](std::size_t k) { return std::span(numbers).subspan(k * all, all); };
  for (std::size_t c = 0; c < components; ++c) {
    const Lacey index = lacey(row(0), row(c + 1));
    found.parts[c].lacey = index.index;
    found.parts[c].lacey_error = index.error;
  }
}

void add_boundaries(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene, double top,
                    std::span<const std::int32_t> stratum, Composition& found) {
  constexpr double bins_a_diameter = 32.0;
  const std::size_t strata = scene.in.strata.size();
  if (strata < 2) return;
  const double width = 2.0 * scene.sizes.mean() / bins_a_diameter;
  const auto bins = static_cast<std::size_t>(std::max(1.0, std::ceil(top / width)));
  std::vector<std::int64_t> units(bins * strata, 0);
  const auto up = static_cast<std::size_t>(scene.container.vertical());
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const double r = store.radius(i), z = store.position(i)[up];
    const auto of = static_cast<std::size_t>(stratum[static_cast<std::size_t>(i)]);
    const auto lowest =
        static_cast<std::size_t>(std::clamp(std::floor((z - r) / width), 0.0, static_cast<double>(bins - 1)));
    std::int64_t below = 0;
    const std::int64_t whole = scene::volume_units(scene, r);
    for (std::size_t bin = lowest; below < whole; ++bin) {
      const double edge = static_cast<double>(bin + 1) * width;
      const std::int64_t to = bin + 1 < bins && edge < z + r ? cut_units(scene, r, z, edge) : whole;
      units[bin * strata + of] += to - below;
      below = to;
    }
  }
  comm.sum(std::span(units));
  for (std::size_t k = 0; k + 1 < strata; ++k) {
    std::int64_t lower = 0, below = 0, strangers = 0;  // of the strata to k; of all below a bin; of those above k
    for (std::size_t n = 0; n < units.size(); ++n) lower += n % strata <= k ? units[n] : 0;
    StratumBoundary boundary{scene.in.strata[k].name, scene.in.strata[k + 1].name};
    boundary.wanted = scene.in.strata[k].top.value_or(0.0);
    for (std::size_t bin = 0; bin < bins; ++bin) {
      std::int64_t here = 0, upper = 0;
      for (std::size_t s = 0; s < strata; ++s) {
        here += units[bin * strata + s];
        upper += s > k ? units[bin * strata + s] : 0;
      }
      if (here > 0 && below + here >= lower) {
        const double part = static_cast<double>(lower - below) / static_cast<double>(here);
        boundary.height = (static_cast<double>(bin) + part) * width;
        strangers += std::llround(part * static_cast<double>(upper));
        break;
      }
      below += here;
      strangers += upper;
    }
    const double solid = static_cast<double>(lower) / std::max(boundary.height, width);  // units a metre of height
    boundary.mixed = solid > 0.0 ? static_cast<double>(strangers) / solid : 0.0;
    found.boundaries.push_back(std::move(boundary));
  }
}

}  // namespace

Lacey lacey(std::span<const std::int64_t> all, std::span<const std::int64_t> own) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  double n = 0.0, k = 0.0, squares = 0.0, cells = 0.0;
  for (std::size_t c = 0; c < all.size(); ++c) {
    if (all[c] == 0) continue;
    const auto of_all = static_cast<double>(all[c]), of_own = static_cast<double>(own[c]);
    n += of_all, k += of_own, squares += of_own * of_own / of_all, cells += 1.0;
  }
  // Without one cell, or none: sum of n_i (p_i - p)^2 = sum k_i^2 / n_i - k^2 / n; by chance, (cells - 1) p (1 - p).
  const auto index = [](double number, double sum, double square, double count) {
    const double p = sum / number, unmixed = p * (1.0 - p);
    const double variance = (square - sum * sum / number) / number;
    return (unmixed - variance) / (unmixed - (count - 1.0) * unmixed / number);
  };
  if (!(cells > 2.0) || !(k > 0.0) || !(k < n)) return {unknown, unknown};
  double mean = 0.0, square = 0.0;
  for (std::size_t c = 0; c < all.size(); ++c) {
    if (all[c] == 0) continue;
    const auto of_all = static_cast<double>(all[c]), of_own = static_cast<double>(own[c]);
    const double without = index(n - of_all, k - of_own, squares - of_own * of_own / of_all, cells - 1.0);
    if (!std::isfinite(without)) return {index(n, k, squares, cells), unknown};
    mean += without / cells;
    square += without * without / cells;
  }
  return {index(n, k, squares, cells), std::sqrt((cells - 1.0) * std::max(0.0, square - mean * mean))};
}

Composition composition(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                        const Bulk& bulk, std::span<const std::int32_t> stratum) {
  Composition found;
  if (!scene.features.mixture) return found;
  constexpr double most_slabs = 200.0;
  const double top = observe::top(comm, store, scene);
  found.slab = std::max(2.0 * scene.sizes.mean(), top / most_slabs);
  add_parts(comm, store, scene, found);
  const Heights heights(comm, store, scene, found.slab, top);
  for (std::size_t slab = 0; slab < heights.slabs; ++slab) {
    const std::int64_t whole = heights.of_slab(slab);
    std::vector<double> shares(heights.components, 0.0);
    for (std::size_t c = 0; c < heights.components && whole > 0; ++c) {
      shares[c] = static_cast<double>(heights.units[slab * heights.components + c]) / static_cast<double>(whole);
    }
    found.shares.push_back(std::move(shares));
  }
  add_lacey(comm, store, scene, bulk, found);
  const std::int64_t known = stratum.empty() ? 0 : 1;
  if (comm.max(known) > 0) add_boundaries(comm, store, scene, top, stratum, found);
  return found;
}

}  // namespace packmpi::observe
