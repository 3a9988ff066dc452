#include "scene/expectation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/elementary.hpp"
#include "geometry/volume.hpp"
#include "input/time_step.hpp"
#include "scene/limits.hpp"
#include "scene/mixture.hpp"

namespace packmpi::scene {
namespace {

// Solid fractions far from walls and surface of equal particles, at friction 0, 0.2 and 0.5 (doc/estimate.md).
using ByFriction = std::array<double, 3>;
constexpr std::array<double, 3> frictions{0.0, 0.2, 0.5};
constexpr ByFriction spheres{0.646, 0.620, 0.609}, spheres_without_spin{0.646, 0.595, 0.539};
constexpr ByFriction discs{0.900, 0.886, 0.886}, discs_without_spin{0.900, 0.833, 0.782};
// Equal discs crystallise; from this standard deviation of the radius over its mean on they do not.
constexpr double no_crystal = 0.1;
constexpr double without_crystal = 0.945;          // discs with spin, by that of equal ones
constexpr double without_crystal_or_spin = 0.985;  // discs without
// What size distributions add in 3D, by standard deviation over mean and skewness (Desmond and Weeks 2014, eq. 2, by
// their 0.634).
constexpr double by_deviation = 0.0658 / 0.634, by_skewness = 0.0857 / 0.634;
constexpr double most_added = 0.25;  // beyond what that formula was found for
// What is missing beside a side wall, in mean diameters; at the surface, in largest diameters, of equal particles and
// of others.
constexpr double missing_at_walls = 0.27, missing_at_surface = 0.12, missing_at_uneven_surface = 0.24;
// The highest top over the mean surface, in mean diameters: 0.9 to 1.3 (doc/estimate.md).
constexpr double roughness = 1.1;
constexpr double known = 0.01, less_known = 0.025;  // error of spheres like those measured, and of all else

double by_friction(const ByFriction& values, double friction) {
  if (friction >= frictions[2]) return values[2];
  const std::size_t k = friction < frictions[1] ? 0 : 1;
  const double share = (friction - frictions[k]) / (frictions[k + 1] - frictions[k]);
  return values[k] + share * (values[k + 1] - values[k]);
}

struct Shape {
  double deviation, skewness;  // of the radius by number: over the mean; third moment over the deviation's cube
};
Shape shape_of(const Sizes& sizes) {
  const double m1 = sizes.curve().moment(1);
  const double variance = std::max(0.0, sizes.curve().moment(2) - m1 * m1);
  const double third = sizes.curve().moment(3) - 3.0 * m1 * sizes.curve().moment(2) + 2.0 * m1 * m1 * m1;
  const double deviation = std::sqrt(variance);
  if (!(deviation > 1e-6 * m1)) return {0.0, 0.0};
  return {deviation / m1, third / (variance * deviation)};
}

// Of equal particles in the bulk, times this.
double by_sizes(const Scene& scene, const Shape& shape) {
  if (scene.container.dimension == 3) {
    const double added =
        by_deviation * shape.deviation + by_skewness * shape.skewness * shape.deviation * shape.deviation;
    return 1.0 + std::clamp(added, 0.0, most_added);
  }
  const double least = scene.in.dynamics.rotation ? without_crystal : without_crystal_or_spin;
  return 1.0 + std::min(1.0, shape.deviation / no_crystal) * (least - 1.0);
}

// The share of the bulk's fraction that walls and surface leave.
double by_borders(const Scene& scene) {
  const double mean = 2.0 * scene.sizes.mean();
  const double largest = 2.0 * scene.sizes.largest();
  // Side walls over the room, times half of it: of a box what its two walls across an axis take.
  double left = 1.0;
  if (scene.container.is_box()) {
    for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.container.lateral_axes()); ++axis) {
      if (!scene.container.periodic[axis]) left -= missing_at_walls * mean / scene.container.size[axis];
    }
  } else {
    left -= missing_at_walls * mean * 0.5 * scene.container.walls_over_volume();
  }
  const double missing = scene.sizes.equal() ? missing_at_surface : missing_at_uneven_surface;
  left *= 1.0 - std::min(0.5, missing * largest / scene.container.height());
  return std::max(0.5, left);
}

double mean_volume(const Scene& scene) {
  return geometry::volume(scene.container.dimension, 1.0) * scene.sizes.curve().moment(scene.container.dimension);
}

// Mean square of the particles' volume over the square of its mean.
double uneven_volumes(const Scene& scene) {
  if (scene.sizes.equal()) return 1.0;
  const double mean = scene.sizes.curve().moment(scene.container.dimension);
  return scene.sizes.curve().moment(2 * scene.container.dimension) / (mean * mean);
}

// Of a vessel that is not straight: layer upon layer, each as high as its region has room for. Full: up to H_d.
struct Stack {
  std::int64_t layers = 0;
  double solid = 0.0, surface = 0.0;  // [m3], [m]
  bool full = false;
};
Stack stack_up(const Scene& scene, double fraction) {
  const input::Layers& layers = scene.in.layers;
  const bool clipped = layers.region == input::RegionRule::container;
  const double target = scene.container.height(), diameter = 2.0 * scene.sizes.largest();
  const double wanted =
      scene.in.particles.count > 0 ? static_cast<double>(scene.in.particles.count) * mean_volume(scene) : HUGE_VAL;
  Stack stack;
  double top = 0.0;
  while (stack.layers < most_layers(scene) && stack.solid < wanted && !stack.full) {
    const double thickness = clipped ? std::min(layers.thickness, target - top) : layers.thickness;
    stack.solid += layers.fraction * scene.container.volume_between(top, top + thickness);
    stack.surface = scene.container.level(stack.solid / fraction);
    top = stack.surface + roughness * 2.0 * scene.sizes.mean();
    ++stack.layers;
    stack.full = clipped ? target - top < diameter : stack.surface >= target && wanted == HUGE_VAL;
  }
  return stack;
}

}  // namespace

BedFraction expected_fraction(const Scene& scene) {
  if (insertion_alone(scene.in)) return {scene.in.layers.fraction, 0.0};
  const bool spin = scene.in.dynamics.rotation;
  const bool flat = scene.container.dimension == 2;
  const ByFriction& equal = flat ? (spin ? discs : discs_without_spin) : (spin ? spheres : spheres_without_spin);
  const Shape shape = shape_of(scene.sizes);
  const double friction = scene.in.contact.friction;
  const bool usual =
      !flat && shape.deviation < 0.35 && friction <= frictions[2] && !scene.in.near_field && scene.sizes.ratio() < 4.0;
  return {by_friction(equal, friction) * by_sizes(scene, shape) * by_borders(scene), usual ? known : less_known};
}

std::int64_t particles_a_layer(const Scene& scene) {
  const double solid = scene.in.layers.fraction * scene.container.mean_area() * scene.in.layers.thickness;
  const double needed = solid / mean_volume(scene);
  // The last one overshoots: the larger a particle, the more often it is the last, so by half of its mean square.
  const double overshoot = 0.5 * uneven_volumes(scene);
  return std::max<std::int64_t>(1, std::llround(scene.sizes.equal() ? std::ceil(needed - 1e-9) : needed + overshoot));
}

double deviation_of_count(const Scene& scene, double particles) {
  return std::sqrt(particles * (uneven_volumes(scene) - 1.0));
}

std::optional<Fines> fines(const Scene& scene, double part) {
  const input::Radius& radius = scene.in.particles.radius;
  const auto graded = [](const input::Radius& of) {
    return of.distribution == input::SizeDistribution::grading && of.weighting == input::Weighting::mass;
  };
  if (!graded(radius) && std::ranges::none_of(radius.parts, graded)) return {};
  Fines found{.part = part};
  const double r = scene.sizes.curve().quantile(input::Weighting::mass, part);
  found.diameter = 2.0 * r;
  found.share = scene.sizes.curve().passing(input::Weighting::number, r);
  found.particles = static_cast<double>(expected_filling(scene, expected_fraction(scene).value).particles);
  found.without = found.particles * (1.0 - found.share) / (1.0 - part);
  return found;
}

double rise_of_layer(const Scene& scene, double fraction) {
  return static_cast<double>(particles_a_layer(scene)) * mean_volume(scene) / (scene.container.mean_area() * fraction);
}

std::int64_t expected_layers(const Scene& scene, double fraction) {
  if (!scene.container.straight() && !insertion_alone(scene.in)) return stack_up(scene, fraction).layers;
  const auto count = static_cast<double>(scene.in.particles.count);
  const double layers = count > 0.0 ? std::ceil(count / static_cast<double>(particles_a_layer(scene)))
                                    : std::ceil(scene.container.height() / rise_of_layer(scene, fraction) - 1e-9);
  return std::clamp<std::int64_t>(std::llround(layers), 1, most_layers(scene));
}

double height_below(const Scene& scene, double target) {
  const double radius = scene.sizes.mean();
  return std::max(radius, target - roughness * 2.0 * radius - scene.sizes.largest());
}

Filling expected_filling(const Scene& scene, double fraction) {
  const double target = scene.container.height();
  const std::int64_t count = scene.in.particles.count;
  if (count > 0 || insertion_alone(scene.in)) {
    const std::int64_t particles = count > 0 ? count : particles_a_layer(scene);
    const double solid = static_cast<double>(particles) * mean_volume(scene) / scene.container.mean_area();
    const double extent = solid * scene.container.mean_area() / fraction;
    const double height = scene.container.straight() ? solid / fraction : scene.container.level(extent);
    return {.layers = expected_layers(scene, fraction),
            .particles = particles,
            .height = insertion_alone(scene.in) ? target : height};
  }
  if (!scene.container.straight()) {
    const Stack stack = stack_up(scene, fraction);
    const bool clipped = stack.full && scene.in.layers.region == input::RegionRule::container;
    const double height = clipped ? height_below(scene, target) : stack.surface;
    const double solid = scene.container.volume_between(0.0, height) * fraction;
    const double a_metre = scene.container.area_at(height) * fraction / mean_volume(scene);
    return {.layers = stack.layers,
            .particles = std::max<std::int64_t>(1, std::llround(solid / mean_volume(scene))),
            .height = height,
            .uncertainty = clipped ? std::llround(a_metre * scene.sizes.largest()) : 0};
  }
  if (scene.in.layers.region == input::RegionRule::open) {
    const std::int64_t layers = expected_layers(scene, fraction);
    return {.layers = layers,
            .particles = layers * particles_a_layer(scene),
            .height = static_cast<double>(layers) * rise_of_layer(scene, fraction)};
  }
  Filling filling;
  double surface = 0.0, top = 0.0;
  while (target - top >= 2.0 * scene.sizes.largest() && filling.layers < most_layers(scene)) {
    surface += scene.in.layers.fraction * std::min(scene.in.layers.thickness, target - top) / fraction;
    top = surface + roughness * 2.0 * scene.sizes.mean();
    ++filling.layers;
  }
  const double a_metre = scene.container.mean_area() * fraction / mean_volume(scene);  // particles
  const bool full = target - top < 2.0 * scene.sizes.largest();
  filling.height = full ? height_below(scene, target) : surface;
  filling.particles = std::max<std::int64_t>(1, std::llround(a_metre * filling.height));
  filling.uncertainty = full ? std::llround(a_metre * scene.sizes.largest()) : 0;
  return filling;
}

double finished_height(const Scene& scene) {
  const double rise = rise_of_layer(scene, expected_fraction(scene).value);
  const double most = static_cast<double>(most_layers(scene)) * rise;
  return scene.in.particles.count > 0 ? expected_filling(scene, expected_fraction(scene).value).height
                                      : std::min(scene.container.height(), most);
}

double pressing_depth(const Scene& scene, double depth) {
  constexpr double lateral = 0.5;  // share of the vertical stress
  const double rate = lateral * scene.in.contact.wall_friction * scene.container.walls_over_volume();
  return rate * depth > 1e-6 ? (1.0 - elementary::exponential(-rate * depth)) / rate : depth;
}

double overlap_below(const Scene& scene, double pressing, double youngs_modulus) {
  // A contact bears sigma 4 pi r^2 / (phi Z) in space, of Z contacts a particle; in the plane sigma 2 pi r / (phi Z).
  constexpr double contacts = 5.0;
  constexpr double uneven = 0.9;  // mean of f^(2/3) over that of the mean force, where forces are as uneven as in packs
  const bool flat = scene.container.dimension == 2;
  const input::Particles soft = softest(scene.in);
  const double stress = soft.density * scene.in.jamming.gravity * pressing;
  if (!(stress > 0.0)) return 0.0;
  const bool mixture = scene.features.mixture;  // softened, if at all, by one factor
  const double modulus =
      mixture ? youngs_modulus / scene.in.particles.youngs_modulus * soft.youngs_modulus : youngs_modulus;
  const double squeeze = (flat ? 2.0 : 3.0) * std::numbers::sqrt2 * std::numbers::pi * stress /
                         (input::pair_modulus(soft, modulus) * contacts);
  const double root = elementary::cube_root(squeeze);
  return uneven * root * root;
}

double expected_overlap(const Scene& scene, double youngs_modulus) {
  constexpr double mean_over_depth = 0.6;
  return mean_over_depth * overlap_below(scene, pressing_depth(scene, finished_height(scene)), youngs_modulus);
}

double modulus_for(const Scene& scene, double overlap, double youngs_modulus) {
  const double times = expected_overlap(scene, youngs_modulus) / overlap;
  return youngs_modulus * times * std::sqrt(times);
}

double mean_stress(const input::Confinement& asked) {
  constexpr double at_rest = 0.5;  // lateral over vertical stress
  const double lateral = asked.on_sides().value_or(at_rest * asked.on_lid());
  return (asked.on_lid() + 2.0 * lateral) / 3.0;
}

double confined_overlap(const Scene& scene) {
  if (!scene.in.confinement) return 0.0;
  constexpr double uneven = 0.9;
  // In the plane stress is that of a sheet as thick as a mean particle: a contact bears as much as in space, and there
  // are fewer of them.
  const double contacts = scene.container.dimension == 3 ? 5.0 : 3.2;
  const double fraction = expected_fraction(scene).value;
  const input::Particles soft = most_compliant(scene.in);
  const double modulus = input::pair_modulus(soft, soft.youngs_modulus);
  const double squeeze = 3.0 * std::numbers::sqrt2 * std::numbers::pi * mean_stress(*scene.in.confinement) /
                         (modulus * fraction * contacts);
  const double root = elementary::cube_root(squeeze);
  return uneven * root * root;
}

}  // namespace packmpi::scene
