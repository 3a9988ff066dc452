/// The size distribution: a radius for every particle, drawn before it is placed.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "base/types.hpp"
#include "input/input.hpp"
#include "scene/size_curve.hpp"

namespace packmpi::scene {

/// Radii as a pure function of (seed, layer, particle), or of a list those of its particles. Local; no state. Copies
/// share the curve and the list.
class Sizes {
 public:
  Sizes() = default;
  /// Cost: of a list of n radii O(n log n), on every rank.
  Sizes(const input::Radius& radius, std::uint64_t seed);

  /// Radius [m] of particle `index` (0 ..) of `layer`, whose particle 0 has the id `first`. Of a list: number
  /// first + index in the order of insertion, the last one beyond its end. Gaussian by number: ratio of uniforms,
  /// redrawn outside [min, max], bounded; uniform by number: one number; all others from the curve.
  [[nodiscard]] double draw(std::uint32_t layer, std::uint64_t index, GlobalId first = 0) const;
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
  std::shared_ptr<const std::vector<double>> list_;  // [m] in the order of insertion; none: the sizes are no list
};

}  // namespace packmpi::scene
