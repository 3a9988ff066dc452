#include <algorithm>
#include <cmath>
#include <numbers>

#include "geometry/round_volume.hpp"
#include "observe/analysis.hpp"

namespace packmpi::observe {
namespace {

constexpr double shells_a_diameter = 20.0;
constexpr double core_in_diameters = 3.0;
constexpr std::size_t most_shells = 1 << 14;

double from_axis(const geometry::Container& vessel, const Vec3& x) { return vessel.round(0).from_axis(x); }

// Solid volume [m3] of the bulk inside each of some coaxial cylinders, whose radii descend. Collective.
std::vector<double> inside(const Specimen& pack, const std::vector<double>& radii) {
  const auto vertical = static_cast<std::size_t>(pack.scene.container.vertical());
  std::vector<std::vector<double>> terms(radii.size());
  for (LocalIndex i = 0; i < pack.store.owned(); ++i) {
    const Vec3 x = pack.store.position(i);
    const double r = pack.store.radius(i);
    const double low = pack.bulk.low - x[vertical], high = pack.bulk.high - x[vertical];
    if (low >= r || high <= -r) continue;
    const double b = from_axis(pack.scene.container, x);
    for (std::size_t k = 0; k < radii.size() && radii[k] > b - r; ++k) {
      terms[k].push_back(geometry::volume_in_cylinder(r, b, radii[k], low, high));
    }
  }
  return comm::exact_sums(pack.comm, terms);
}

}  // namespace

RadialProfile radial_profile(const Specimen& pack) {
  const geometry::Container& vessel = pack.scene.container;
  RadialProfile result;
  const double depth = pack.bulk.depth();
  if (vessel.is_box() || !(depth > 0.0)) return result;
  const double diameter = 2.0 * pack.scene.sizes.mean();
  const double around = vessel.radius();
  const double width = std::max(diameter / shells_a_diameter, around / static_cast<double>(most_shells));
  std::vector<double> radii;  // of the shells' outer sides, from the wall inwards; then the axis
  for (std::size_t k = 0; static_cast<double>(k) * width < around; ++k) {
    radii.push_back(around - static_cast<double>(k) * width);
  }
  const std::size_t shells = radii.size();
  radii.push_back(0.0);
  const double core = around - core_in_diameters * diameter;
  std::vector<double> volumes = inside(pack, radii);
  result.profile = {.from = 0.0, .width = width, .values = {}};
  for (std::size_t k = 0; k < shells; ++k) {
    const double room = std::numbers::pi * (radii[k] - radii[k + 1]) * (radii[k] + radii[k + 1]) * depth;
    result.profile.values.push_back((volumes[k] - volumes[k + 1]) / room);
  }
  result.from_walls = core_in_diameters * diameter;
  if (core >= 0.5 * diameter) {
    result.core = inside(pack, {core})[0] / (std::numbers::pi * core * core * depth);
  }
  return result;
}

}  // namespace packmpi::observe
