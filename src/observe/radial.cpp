#include <algorithm>
#include <cmath>
#include <numbers>

#include "comm/exact_sum.hpp"
#include "geometry/round_volume.hpp"
#include "observe/analysis.hpp"
#include "observe/radial_points.hpp"

namespace packmpi::observe {
namespace {

using geometry::Surface;

constexpr std::size_t most_shells = 1 << 14;

// Solid volume [m3] of the bulk that is away from a wall by at least each of some distances, which ascend. Collective.
std::vector<double> solid_away(const Specimen& pack, Surface surface, const std::vector<double>& margins) {
  const geometry::Container& vessel = pack.scene.container;
  const auto up = static_cast<std::size_t>(vessel.vertical());
  std::vector<comm::ExactSum> terms(margins.size());
  for (LocalIndex i = 0; i < pack.store.owned(); ++i) {
    const Vec3 x = pack.store.position(i);
    const double r = pack.store.radius(i);
    if (pack.bulk.low - x[up] >= r || pack.bulk.high - x[up] <= -r) continue;
    const double reach = (vessel.is_polygon() ? vessel.from_sides(x) : vessel.facing(surface, x).distance) + r;
    for (std::size_t k = 0; k < margins.size() && margins[k] < reach; ++k) {
      terms[k].add(geometry::volume_away_from(vessel, surface, margins[k], x, r, pack.bulk.low, pack.bulk.high));
    }
  }
  return comm::exact_sums(pack.comm, terms);
}

// The farthest that a point between two heights can be from the sides of a polygon [m].
double widest_margin(const geometry::Container& vessel, double low, double high) {
  double inside = 0.0, outside = vessel.radius();
  for (int turn = 0; turn < 50; ++turn) {
    const double middle = 0.5 * (inside + outside);
    (vessel.volume_within(middle, low, high) > 0.0 ? inside : outside) = middle;
  }
  return inside;
}

// The farthest that a point of the bulk can be from a wall [m].
double farthest(const Specimen& pack, Surface surface) {
  const geometry::Container& vessel = pack.scene.container;
  if (vessel.shape == geometry::Shape::annulus) return vessel.radius() - vessel.core;
  const auto at = [&](double z) {
    return vessel.facing(surface, vessel.at(0.5 * vessel.size[0], 0.5 * vessel.size[1], z)).distance;
  };
  if (vessel.straight()) return vessel.radius();
  const double low = pack.bulk.low, high = pack.bulk.high;
  if (vessel.is_polygon()) return widest_margin(vessel, low, high);
  const double middle = std::clamp(vessel.radius(), low, high);  // a sphere's
  return std::max({at(low), at(high), vessel.shape == geometry::Shape::sphere ? at(middle) : 0.0});
}

// Of the bulk's interior what is between two distances from a wall [m3].
double shell(const Specimen& pack, Surface surface, double from, double to) {
  const geometry::Container& vessel = pack.scene.container;
  const double low = pack.bulk.low, high = pack.bulk.high;
  if (!vessel.straight()) return vessel.volume_within(from, low, high) - vessel.volume_within(to, low, high);
  const bool inner = surface == Surface::inner;
  const double a = inner ? vessel.core + to : vessel.radius() - from;
  const double b = inner ? vessel.core + from : vessel.radius() - to;
  return std::numbers::pi * (a - b) * (a + b) * (high - low);
}

// Collective.
Profile profile_from(const Specimen& pack, Surface surface) {
  const double diameter = 2.0 * pack.scene.sizes.mean(), end = farthest(pack, surface);
  const double width = std::max(diameter / shells_a_diameter, end / static_cast<double>(most_shells));
  std::vector<double> margins;
  for (std::size_t k = 0; static_cast<double>(k) * width < end; ++k) margins.push_back(static_cast<double>(k) * width);
  const std::size_t shells = margins.size();
  margins.push_back(end);
  const std::vector<double> volumes = solid_away(pack, surface, margins);
  Profile profile{.from = 0.0, .width = width, .values = {}};
  for (std::size_t k = 0; k < shells; ++k) {
    const double volume = shell(pack, surface, margins[k], margins[k + 1]);
    profile.values.push_back(volume > 0.0 ? (volumes[k] - volumes[k + 1]) / volume : 0.0);
  }
  return profile;
}

// Solid fraction of what is at least so far from all side walls; 0 if that is narrower than a diameter. Collective.
double core_of(const Specimen& pack, double margin) {
  const geometry::Container& vessel = pack.scene.container;
  const double diameter = 2.0 * pack.scene.sizes.mean(), depth = pack.bulk.depth();
  const double section = vessel.dimension == 3 ? 0.25 * std::numbers::pi * diameter * diameter : diameter;
  const double volume = vessel.volume_within(margin, pack.bulk.low, pack.bulk.high);
  std::vector<double> margins{margin};
  if (vessel.shape == geometry::Shape::annulus) {
    const double gap = vessel.radius() - vessel.core;
    if (gap - 2.0 * margin < diameter) return 0.0;
    margins.push_back(gap - margin);  // what the inner wall takes
  } else if (vessel.straight() ? vessel.radius() - margin < 0.5 * diameter : volume < section * depth) {
    return 0.0;
  }
  std::vector<double> volumes = solid_away(pack, Surface::mantle, margins);
  volumes.push_back(0.0);
  return (volumes[0] - volumes[1]) / volume;
}

}  // namespace

RadialProfile radial_profile(const Specimen& pack) {
  RadialProfile result;
  if (pack.scene.container.is_box() || !(pack.bulk.depth() > 0.0)) return result;
  if (pack.scene.container.is_mesh()) return radial_by_points(pack);
  result.profile = profile_from(pack, Surface::mantle);
  if (pack.scene.container.has(Surface::inner)) result.from_inner = profile_from(pack, Surface::inner);
  result.from_walls = core_in_diameters * 2.0 * pack.scene.sizes.mean();
  result.core = core_of(pack, result.from_walls);
  return result;
}

}  // namespace packmpi::observe
