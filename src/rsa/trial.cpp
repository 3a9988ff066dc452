#include "base/random.hpp"
#include "rsa/insert.hpp"
#include "rsa/sphere.hpp"

namespace packmpi::rsa {

Vec3 trial(const scene::Scene& scene, const LayerRegion& region, std::uint64_t particle, double radius,
           std::uint32_t attempt) {
  const auto u = random::uniforms({scene.in.seed, random::Purpose::trial, region.layer, particle, attempt});
  return scene.container.draw({u[0], u[1], u[2]}, radius, region.bottom, region.thickness);
}

bool overlap(const geometry::Container& box, const Vec3& a, double ra, const Vec3& b, double rb) {
  return Metric(box).overlap({a, ra}, {b, rb});
}

}  // namespace packmpi::rsa
