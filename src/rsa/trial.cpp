#include "base/random.hpp"
#include "rsa/insert.hpp"
#include "rsa/sphere.hpp"

namespace packmpi::rsa {

Vec3 trial(const scene::Scene& scene, const LayerRegion& region, std::uint64_t particle, double radius,
           std::uint32_t attempt) {
  const auto u = random::uniforms({scene.in.seed, random::Purpose::trial, region.layer, particle, attempt});
  const geometry::Container& box = scene.container;
  Vec3 position = box.draw({u[0], u[1], u[2]}, radius);
  const auto up = static_cast<std::size_t>(box.vertical());
  position[up] = region.bottom + radius + u[up] * (region.thickness - 2.0 * radius);
  return position;
}

bool overlap(const geometry::Container& box, const Vec3& a, double ra, const Vec3& b, double rb) {
  return Metric(box).overlap({a, ra}, {b, rb});
}

}  // namespace packmpi::rsa
