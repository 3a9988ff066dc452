/// The size distribution: a radius for every particle, drawn before it is placed.
#pragma once
#include <cstdint>

#include "input/input.hpp"

namespace packmpi::scene {

/// Radii as a pure function of (seed, layer, particle). Local; no state.
class Sizes {
 public:
  Sizes() = default;
  Sizes(const input::Radius& radius, std::uint64_t seed) : radius_(radius), seed_(seed) {}

  /// Radius [m] of particle `index` (0 ..) of `layer`. Gaussian: ratio of uniforms, redrawn outside [min, max];
  /// bounded.
  [[nodiscard]] double draw(std::uint32_t layer, std::uint64_t index) const;
  [[nodiscard]] bool equal() const noexcept { return radius_.distribution == input::SizeDistribution::equal; }
  [[nodiscard]] double smallest() const noexcept { return equal() ? radius_.value : radius_.min; }  ///< [m]
  [[nodiscard]] double largest() const noexcept { return equal() ? radius_.value : radius_.max; }   ///< [m]
  [[nodiscard]] double mean() const noexcept;  ///< [m] of the distribution as truncated

 private:
  input::Radius radius_;
  std::uint64_t seed_ = 1;
};

}  // namespace packmpi::scene
