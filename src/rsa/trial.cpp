#include "base/random.hpp"
#include "rsa/insert.hpp"
#include "rsa/sphere.hpp"

namespace packmpi::rsa {

Vec3 trial(const scene::Scene& scene, const LayerRegion& region, std::uint64_t particle, double radius,
          std::uint32_t attempt) {
  const auto u = random::uniforms({scene.in.seed, random::Purpose::trial, region.layer, particle, attempt});
  const geometry::Box& box = scene.box;
  Vec3 position{};
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(box.lateral_axes()); ++axis) {
    const double length = box.size[axis];
    position[axis] =
        box.periodic[axis] ? geometry::wrap(u[axis] * length, length) : radius + u[axis] * (length - 2.0 * radius);
  }
  const auto up = static_cast<std::size_t>(box.vertical());
  position[up] = region.bottom + radius + u[up] * (region.thickness - 2.0 * radius);
  return position;
}

bool overlap(const geometry::Box& box, const Vec3& a, double ra, const Vec3& b, double rb) {
  return Metric(box).overlap({a, ra}, {b, rb});
}

}  // namespace packmpi::rsa
