/// Scenes for the RSA tests, made by hand.
#pragma once
#include <algorithm>
#include <array>
#include <string>

#include "geometry/columns.hpp"
#include "scene/scene.hpp"

namespace packmpi::test {

inline input::Radius equal_radius(double value) {
  input::Radius radius;
  radius.value = value;
  return radius;
}

inline input::Radius uniform_radius(double min, double max) {
  input::Radius radius;
  radius.distribution = input::SizeDistribution::uniform;
  radius.min = min;
  radius.max = max;
  return radius;
}

inline input::Radius gaussian_radius(double mean, double sd, double min, double max) {
  input::Radius radius;
  radius.distribution = input::SizeDistribution::gaussian;
  radius.mean = mean;
  radius.sd = sd;
  radius.min = min;
  radius.max = max;
  return radius;
}

/// `size`: lateral extents, then the height.
inline scene::Scene rsa_scene(int dimension, const Vec3& size, std::array<bool, 2> periodic,
                              const input::Radius& radius, double fraction, std::int64_t attempts,
                              std::uint64_t seed = 1) {
  scene::Scene scene;
  scene.in.seed = seed;
  scene.in.particles.radius = radius;
  scene.in.layers.fraction = fraction;
  scene.in.layers.attempts = attempts;
  scene.in.layers.velocity = {0.5, 0.25, 0.125};
  scene.container.dimension = dimension;
  scene.container.size = size;
  scene.container.periodic = periodic;
  scene.features.dimension = dimension;
  scene.sizes = scene::Sizes(radius, seed);
  scene.reach = 2.0 * scene.sizes.largest();
  scene.skin = 0.1 * scene.sizes.largest();
  return scene;
}

inline geometry::ColumnGrid rsa_grid(const scene::Scene& scene) { return {scene.container, scene.column_width()}; }

}  // namespace packmpi::test
