#include "rsa/mixing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "scene/mixture.hpp"

namespace packmpi::rsa {
namespace {

constexpr std::int64_t nowhere = std::numeric_limits<std::int64_t>::max();
constexpr int most_rounds = 10000;  // two or three are needed

// As many of the next particles of a component as come nearest to `missing` units: those whose middle is below it.
Portion portion_by_number(int component, std::int64_t first, std::int64_t missing) {
  constexpr std::int64_t one = scene::units_a_particle;
  const std::int64_t count = missing > one / 2 ? (missing - one / 2 + one - 1) / one : 0;
  return {component, first, count, count * one};
}

Portion portion_by_volume(const comm::Comm& comm, const scene::Scene& scene, int component, std::int64_t first,
                          std::int64_t missing) {
  Portion portion{component, first, 0, 0};
  const scene::SizeCurve& curve = scene.component_sizes[static_cast<std::size_t>(component)].curve();
  const double mean = geometry::volume(3, 1.0) * curve.moment(3) / scene::volume_unit(scene);
  for (int block = 0; block < most_rounds && missing > portion.units; ++block) {
    const std::int64_t each =
        static_cast<std::int64_t>(static_cast<double>(missing - portion.units) / mean / comm.size()) + 1;
    const std::int64_t begin = portion.count + comm.rank() * each;
    std::vector<std::int64_t> units(static_cast<std::size_t>(each));
    std::int64_t mine = 0;
    for (std::int64_t k = 0; k < each; ++k) {
      const auto number = static_cast<std::uint64_t>(first + begin + k);
      mine += units[static_cast<std::size_t>(k)] = scene::units_of(scene, scene::radius_of(scene, component, number));
    }
    std::int64_t sum = portion.units + comm.sum_below(mine), reached = nowhere;
    for (std::int64_t k = 0; k < each && reached == nowhere; ++k) {
      const std::int64_t own = units[static_cast<std::size_t>(k)];
      if (sum + own / 2 >= missing) reached = begin + k;
      sum += own;
    }
    const std::int64_t end = std::min(comm.min(reached), portion.count + each * comm.size());
    std::int64_t taken = 0;
    for (std::int64_t k = begin; k < std::min(end, begin + each); ++k)
      taken += units[static_cast<std::size_t>(k - begin)];
    portion.units += comm.sum(taken);
    portion.count = end;
    if (comm.min(reached) != nowhere) return portion;
  }
  if (missing > portion.units) throw std::logic_error("rsa: the particles' volume does not grow");
  return portion;
}

}  // namespace

void plan_layer(const comm::Comm& comm, const scene::Scene& scene, double fraction, control::Mixing& mixing,
                LayerRegion& region) {
  const double whole =
      scene.in.layers.fraction * scene.container.mean_area(region.bottom, region.thickness) * region.thickness;
  const double left = control::left_in_stratum(scene, fraction, mixing);
  const double extent = std::min(whole, left);
  const scene::Recipe recipe = scene::recipe_of(scene, static_cast<std::size_t>(mixing.stratum));
  const double particles = extent / recipe.mean_extent;
  region.portions.clear();
  for (std::size_t k = 0; k < recipe.numbers.size(); ++k) {
    const double units = scene::by_number(scene)
                             ? particles * recipe.numbers[k] * static_cast<double>(scene::units_a_particle)
                             : particles * recipe.mean_volume * recipe.volumes[k] / scene::volume_unit(scene);
    mixing.wanted[k] += std::llround(units);
    const std::int64_t missing = recipe.numbers[k] > 0.0 ? mixing.wanted[k] - mixing.units[k] : 0;
    const int component = static_cast<int>(k);
    const Portion portion = scene::by_number(scene)
                                ? portion_by_number(component, mixing.drawn[k], missing)
                                : portion_by_volume(comm, scene, component, mixing.drawn[k], missing);
    mixing.counts.push_back(portion.count);
    mixing.drawn[k] += portion.count;
    mixing.units[k] += portion.units;
    region.portions.push_back(portion);
  }
  mixing.extent += extent;
  mixing.stratum_extent += extent;
  if (left <= whole) ++mixing.stratum_layers;
  mixing.strata.push_back(mixing.stratum);
}

}  // namespace packmpi::rsa
