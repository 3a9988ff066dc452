#include "control/sample.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "geometry/volume.hpp"
#include "scene/expectation.hpp"

namespace packmpi::control {
namespace {

constexpr double few = 4000.0;               // particles: a scene of no more is its own sample
constexpr double sample_particles = 2500.0;  // particles of a sample
// Least lengths of a sample, in diameters of a particle of mean volume, and in largest ones.
constexpr double height_in_mean = 14.0, height_in_largest = 6.0, side_in_mean = 6.0, side_in_columns = 4.0;
constexpr double least_layers = 2.0;

double mean_volume(const scene::Scene& scene) {
  const int dimension = scene.container.dimension;
  return geometry::volume(dimension, 1.0) * scene.sizes.curve().moment(dimension);
}

// [m] of a particle of mean volume.
double mean_diameter(const scene::Scene& scene) {
  const double moment = scene.sizes.curve().moment(scene.container.dimension);
  return 2.0 * (scene.container.dimension == 3 ? elementary::cube_root(moment) : std::sqrt(moment));
}

double particles_in(const scene::Scene& scene) {
  const double fraction = scene::expected_fraction(scene).value;
  return static_cast<double>(scene::expected_layers(scene, fraction) * scene::particles_a_layer(scene));
}

double sample_height(const scene::Scene& scene, double mean_diameter) {
  const double rise = scene::rise_of_layer(scene, scene::expected_fraction(scene).value);
  const double least =
      std::max({height_in_mean * mean_diameter, height_in_largest * 2.0 * scene.sizes.largest(), least_layers * rise});
  return std::min(scene.container.height(), least);
}

// A sample has not the whole list, but the same sizes as often.
void draw_from_list(input::Radius& radius) {
  std::ranges::sort(radius.radii);
  radius.distribution = input::SizeDistribution::discrete;
  radius.weighting = input::Weighting::number;
  radius.shares.assign(radius.radii.size(), 1.0 / static_cast<double>(radius.radii.size()));
}

input::Input smaller(const scene::Scene& scene) {
  const double volume = mean_volume(scene);
  const int dimension = scene.container.dimension;
  const double diameter = mean_diameter(scene);
  input::Input in = scene.in;
  in.particles.count = 0;  // as high as a sample is
  if (in.particles.radius.distribution == input::SizeDistribution::list) draw_from_list(in.particles.radius);
  in.container.size.back() = sample_height(scene, diameter);
  const double area =
      sample_particles * volume / (scene::expected_fraction(scene).value * in.container.size.back());  // 2D: a length
  const double side = std::max(
      {dimension == 3 ? std::sqrt(area) : area, side_in_mean * diameter, side_in_columns * scene.column_width()});
  if (!scene.container.straight()) std::fill(in.container.size.begin(), in.container.size.end() - 1, side);
  const bool middle = side < scene.container.size[0] || !scene.container.straight();
  if (middle) in.container.shape = input::VesselShape::box;  // that of a round vessel
  for (std::size_t axis = 0; axis < in.container.boundary.size(); ++axis) {
    if (!(side < in.container.size[axis]) && scene.container.straight()) continue;
    in.container.size[axis] = side;
    in.container.boundary[axis] = input::Boundary::periodic;
  }
  return in;
}

// By the walls that the scene has and the sample has not; at equal heights, whose surfaces make up for each other.
double wall_scale(scene::Scene scene, const scene::Scene& sample) {
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  if (scene.container.straight()) scene.container.size[vertical] = sample.container.size[vertical];
  scene.in.particles.count = 0;
  return scene::expected_fraction(scene).value / scene::expected_fraction(sample).value;
}

// [m] of bed above that presses like the stress.
double pressing_of_stress(const scene::Scene& scene) {
  const double weight = scene.in.particles.density * scene.in.jamming.gravity * scene::expected_fraction(scene).value;
  return scene::mean_stress(*scene.in.confinement) / weight;
}

}  // namespace

bool confined_density(const scene::Scene& scene) {
  return scene.in.confinement && scene.in.target && scene.in.target->state == input::TargetState::confined;
}

Sample sample_of(const scene::Scene& scene) {
  const double particles = particles_in(scene);
  if (particles <= few) return {.scene = scene, .whole = true, .particles = particles};
  Sample sample{.scene = scene::build(smaller(scene))};
  sample.scale = wall_scale(scene, sample.scene);
  sample.particles = particles_in(sample.scene);
  return sample;
}

Squeeze squeeze_of(const scene::Scene& scene, double surface, const Slab& slab) {
  // Particles nearer by half an overlap each: a strain along each axis.
  const double axes = scene.container.dimension;
  const double per_overlap = 0.5 * axes * scene::expected_fraction(scene).value;
  const double under = confined_density(scene) ? pressing_of_stress(scene) : 0.0;
  const auto gain = [&](double pressing) {
    return per_overlap * scene::overlap_below(scene, std::max(pressing, 0.0), scene.in.particles.youngs_modulus);
  };
  const double sample = sample_height(scene, mean_diameter(scene));  // without walls
  const Slab same = surface > sample ? buried(sample, 2.0 * scene.sizes.mean()) : slab;
  return {.sample = gain(std::min(surface, sample) - 0.5 * (same.low + same.high)),
          .ordered = gain(under + 0.5 * sample),
          .now = gain(scene::pressing_depth(scene, surface - 0.5 * (slab.low + slab.high))),
          .next = gain(under + scene::pressing_depth(scene, scene::finished_height(scene) - surface))};
}

}  // namespace packmpi::control
