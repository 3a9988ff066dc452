/// How far lists allow each particle to move before they are made anew.
#pragma once
#include <algorithm>

#include "scene/scene.hpp"

namespace packmpi::neighbor {

/// A pair is listed up to the margins of both beyond touching. In a settling layer few particles are fast, and most of
/// the pairs are of slow ones: a margin that grows with the speed makes lists last several times longer than one that
/// is the same for all, at the price of few more pairs. Where a scene allows no more than half a skin, all have that.
/// No result depends on margins.
class Margins {
 public:
  explicit Margins(const scene::Scene& scene)
      : most_(std::max(scene.most_margin, 0.5 * scene.skin)),
        least_((most_ > 0.5 * scene.skin ? least_in_skins : 0.5) * scene.skin) {}

  /// For lists made when no particle of any rank is faster than `speed` [m/s]: the fastest get the most, but none more
  /// than it needs for most_steps steps of `time_step` [s].
  void plan(double speed, double time_step) noexcept {
    const double room = most_ - least_, longest = most_steps * time_step;
    time_ = speed * longest > room ? room / speed : longest;
  }
  /// [m] Of a particle of that speed [m/s].
  [[nodiscard]] double of(double speed) const noexcept { return std::min(least_ + speed * time_, most_); }
  [[nodiscard]] double most() const noexcept { return most_; }  ///< [m]

 private:
  static constexpr double least_in_skins = 0.3, most_steps = 64.0;  // doc/performance.md
  double most_, least_;
  double time_ = 0.0;  // [s] as long as a particle that keeps its speed stays within its margin, at least
};

}  // namespace packmpi::neighbor
