/// How far lists allow each particle to move before they are made anew.
#pragma once
#include <algorithm>

#include "scene/scene.hpp"

namespace packmpi::neighbor {

/// A pair is listed up to the margins of both beyond touching. In a settling layer few particles are fast, and most of
/// the pairs are of slow ones: a margin that grows with the speed makes lists last several times longer than one that
/// is the same for all, at the price of few more pairs. A slow particle may be hit by the fastest, and in a large bed
/// one is at any time: its margin is what the fastest needs for a dozen steps, little in a bed that comes to rest and
/// much where steps are large. Where a scene allows no more than half a skin, all have that. No result depends on
/// margins.
class Margins {
 public:
  explicit Margins(const scene::Scene& scene)
      : alike_(!(scene.most_margin > 0.5 * scene.skin)),
        most_(alike_ ? 0.5 * scene.skin : scene.most_margin),
        lowest_(std::min(lowest_in_skins * scene.skin, most_)),
        least_(alike_ ? most_ : lowest_) {}

  /// For lists made when no particle of any rank is faster than `speed` [m/s]: the fastest get the most, but none more
  /// than it needs for most_steps steps of `time_step` [s].
  void plan(double speed, double time_step) noexcept {
    if (!alike_) least_ = std::clamp(steps_when_hit * speed * time_step, lowest_, most_);
    const double room = most_ - least_, longest = most_steps * time_step;
    time_ = speed * longest > room ? room / speed : longest;
  }
  /// [m] Of a particle of that speed [m/s].
  [[nodiscard]] double of(double speed) const noexcept { return std::min(least_ + speed * time_, most_); }
  [[nodiscard]] double most() const noexcept { return most_; }  ///< [m]

 private:
  static constexpr double lowest_in_skins = 0.1, steps_when_hit = 12.0, most_steps = 64.0;  // doc/performance.md
  bool alike_;
  double most_, lowest_;
  double least_;       // of a particle at rest
  double time_ = 0.0;  // [s] as long as a particle that keeps its speed stays within its margin, at least
};

}  // namespace packmpi::neighbor
