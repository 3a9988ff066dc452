/// Random sequential addition straight from its definition: one loop, every pair tested. For tests only; O(n^2).
#pragma once
#include <cstdint>
#include <vector>

#include "rsa/insert.hpp"

namespace packmpi::oracle {

struct PlacedSphere {
  std::uint64_t particle;  ///< index in the layer
  Vec3 position;           ///< [m]
  double radius;           ///< [m]
  std::uint32_t attempt;   ///< the trial that stayed
};

struct Rsa {
  std::vector<PlacedSphere> placed;  ///< ascending by particle
  std::int64_t target = 0;
  std::int64_t trials = 0;
};

/// Smallest count of particles that fills the fraction of the region, added up one by one.
[[nodiscard]] std::int64_t particles_needed(const scene::Scene& scene, const rsa::LayerRegion& region);

/// At most `attempts` trials a particle; fewer are placed than asked if they do not suffice. Local.
[[nodiscard]] Rsa insert(const scene::Scene& scene, const rsa::LayerRegion& region, std::uint32_t attempts);

}  // namespace packmpi::oracle
