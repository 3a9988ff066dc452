#include "support/oracle_rsa.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/volume.hpp"

namespace packmpi::oracle {
namespace {

// True if the sphere was placed.
bool try_place(const scene::Scene& scene, const PlacedSphere& sphere, Rsa& result) {
  ++result.trials;
  if (std::isnan(sphere.position[2])) return false;
  for (const PlacedSphere& other : result.placed) {
    if (rsa::overlap(scene.container, sphere.position, sphere.radius, other.position, other.radius)) return false;
  }
  result.placed.push_back(sphere);
  return true;
}

}  // namespace

std::int64_t particles_needed(const scene::Scene& scene, const rsa::LayerRegion& region) {
  const long double target = static_cast<long double>(scene.in.layers.fraction) *
                             scene.container.mean_area(region.bottom, region.thickness) * region.thickness;
  long double sum = 0.0L;
  std::uint64_t n = 0;
  while (sum < target) sum += geometry::volume(scene.container.dimension, scene.sizes.draw(region.layer, n++));
  return static_cast<std::int64_t>(n);
}

Rsa insert(const scene::Scene& scene, const rsa::LayerRegion& region, std::uint32_t attempts) {
  Rsa result;
  result.target = particles_needed(scene, region);
  std::vector<std::uint64_t> left;
  for (int size_class = 0; size_class < rsa::size_classes && left.empty(); ++size_class) {
    for (std::uint64_t particle = 0; particle < static_cast<std::uint64_t>(result.target); ++particle) {
      if (rsa::size_class(scene.sizes, scene.sizes.draw(region.layer, particle)) == size_class)
        left.push_back(particle);
    }
    for (std::uint32_t attempt = 0; attempt < attempts; ++attempt) {
      std::erase_if(left, [&](std::uint64_t particle) {
        const double radius = scene.sizes.draw(region.layer, particle);
        return try_place(scene, {particle, rsa::trial(scene, region, particle, radius, attempt), radius, attempt},
                         result);
      });
    }
  }
  std::ranges::sort(result.placed, {}, &PlacedSphere::particle);
  return result;
}

}  // namespace packmpi::oracle
