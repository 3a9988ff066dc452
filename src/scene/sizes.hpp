/// The size distribution: a radius for every particle, drawn before it is placed.
#pragma once
#include <cstdint>
#include <memory>

#include "input/input.hpp"
#include "scene/size_curve.hpp"

namespace packmpi::scene {

/// Radii as a pure function of (seed, layer, particle). Local; no state. Copies share the curve.
class Sizes {
 public:
  Sizes() = default;
  Sizes(const input::Radius& radius, std::uint64_t seed)
      : radius_(radius), seed_(seed), curve_(std::make_shared<const SizeCurve>(radius)) {}

  /// Radius [m] of particle `index` (0 ..) of `layer`. Gaussian by number: ratio of uniforms, redrawn outside
  /// [min, max], bounded; uniform by number: one number; all others from the curve.
  [[nodiscard]] double draw(std::uint32_t layer, std::uint64_t index) const;
  [[nodiscard]] bool equal() const noexcept { return radius_.distribution == input::SizeDistribution::equal; }
  [[nodiscard]] double smallest() const noexcept { return bounded() ? radius_.min : curve_->smallest(); }  ///< [m]
  [[nodiscard]] double largest() const noexcept { return bounded() ? radius_.max : curve_->largest(); }    ///< [m]
  /// [m] largest() / smallest()
  [[nodiscard]] double ratio() const noexcept { return largest() / smallest(); }
  [[nodiscard]] double mean() const noexcept;  ///< [m] by number, of the distribution as truncated
  /// Shares, quantiles and moments of the distribution as truncated.
  [[nodiscard]] const SizeCurve& curve() const noexcept { return *curve_; }

 private:
  // Gaussian and uniform by number are drawn without the curve.
  [[nodiscard]] bool bounded() const noexcept {
    return radius_.weighting == input::Weighting::number &&
           (radius_.distribution == input::SizeDistribution::gaussian ||
            radius_.distribution == input::SizeDistribution::uniform);
  }
  input::Radius radius_;
  std::uint64_t seed_ = 1;
  std::shared_ptr<const SizeCurve> curve_;
};

}  // namespace packmpi::scene
