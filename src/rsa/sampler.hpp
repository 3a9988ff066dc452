/// Trials and the rank each belongs to.
#pragma once
#include "rsa/insert.hpp"
#include "rsa/sphere.hpp"

namespace packmpi::rsa {

/// Consecutive attempts that are thrown together: `first` .. `first + count - 1`. How many that are changes no result.
struct Volley {
  std::uint32_t first;
  std::uint32_t count;
  [[nodiscard]] std::uint32_t last() const noexcept { return first + count - 1; }
};

/// Makes any trial of a layer anywhere, since trials are pure functions of their names. Local.
class Sampler {
 public:
  Sampler(const scene::Scene& scene, const scene::Ownership& ownership, const LayerRegion& region)
      : scene_(&scene), ownership_(&ownership), region_(region) {}

  [[nodiscard]] Trial trial(std::uint64_t particle, double radius, std::uint32_t attempt) const {
    return {particle, attempt, {rsa::trial(*scene_, region_, particle, radius, attempt), radius}};
  }
  /// The rank in whose column the trial falls.
  [[nodiscard]] Rank owner(const Trial& trial) const {
    return ownership_->owner(ownership_->grid().column(trial.sphere.centre));
  }

 private:
  const scene::Scene* scene_;
  const scene::Ownership* ownership_;
  LayerRegion region_;
};

}  // namespace packmpi::rsa
