/// Random sequential addition of one layer, on all ranks, equal to the serial loop particle by particle.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "comm/comm.hpp"
#include "particles/store.hpp"
#include "scene/ownership.hpp"
#include "scene/scene.hpp"

namespace packmpi::rsa {

/// The particles of a component in a layer, which stand together: number `first` of them all and those behind it.
struct Portion {
  int component = 0;
  std::int64_t first = 0;  ///< 0 .., over all layers
  std::int64_t count = 0;
  std::int64_t units = 0;  ///< what they add up to, see scene/mixture.hpp
};

/// Where and what to insert.
struct LayerRegion {
  std::uint32_t layer = 0;             ///< 0 ..
  double bottom = 0.0;                 ///< [m] T: top of the highest particle so far
  double thickness = 0.0;              ///< [m] h_0
  GlobalId first_id = 0;               ///< id of the layer's particle 0; ids ascend with the particle index
  bool clipped = false;                ///< ends at H_d: it may have to do with fewer particles than phi_0 asks for
  std::vector<Portion> portions = {};  ///< of several components; see rsa/mixing.hpp
};

/// What particle `index` (0 ..) of the layer is.
struct Drawn {
  double radius = 0.0;  ///< [m]
  int component = 0;    ///< 0 if there is one only
};
[[nodiscard]] Drawn drawn(const scene::Scene& scene, const LayerRegion& region, std::uint64_t index);

/// What came of it; the same on all ranks and for any number of them.
struct Insertion {
  std::int64_t inserted = 0;
  std::int64_t trials = 0;    ///< positions tried
  double solid_volume = 0.0;  ///< [m3] (2D: m2)
  std::int64_t target = 0;    ///< particles needed to reach phi_0
};

/// How many particles the layer needs: the smallest n whose radii 0 .. n-1 have solid volume >= fraction * region
/// volume, and of a number of particles asked for what is left of it; all of it where insertion is all there is.
/// Collective. Exact sum, O(n / ranks) work and memory.
[[nodiscard]] std::int64_t particles_needed(const comm::Comm& comm, const scene::Scene& scene,
                                            const LayerRegion& region);

/// Graded particles are placed in so many classes, the largest first: in any other order the last large ones find no
/// room (CC16 example 5.4: a million trials do not suffice). Equal particles are all in class 0.
inline constexpr int size_classes = 8;

/// True if the classes have equal ratios of radius, not equal differences: radii of more than 1:3.
[[nodiscard]] bool wide_classes(const scene::Sizes& sizes);
/// The largest radius [m] of class k of wide classes.
[[nodiscard]] double class_bound(const scene::Sizes& sizes, int k);
/// The class of a radius [m]: equal parts of [smallest, largest] or of its logarithm, 0 holds the largest.
[[nodiscard]] int size_class(const scene::Sizes& sizes, double radius);

/// Collective. Throws every particle's first trial, then the second trials of those rejected, and so on, in the order
/// (size class, attempt, particle); a trial is kept if it overlaps none kept before it. Appends the placed particles of
/// this rank's columns to `store`. Throws Error(bad_input) on all ranks, naming target, placed and trials, if a
/// particle is unplaced after layers.attempts trials; or earlier, once so few trials find room that the attempts left
/// cannot suffice; a clipped layer begins anew with nine tenths of its particles instead, the first ones, so that the
/// sizes are still those drawn. Calls `between_volleys`, if given, on all ranks before each of a layer's volleys; what
/// it throws leaves with a part of the layer in `store`. Cost: O(trials / ranks) work, O(target / ranks) memory,
/// messages only to the ranks where trials fall.
[[nodiscard]] Insertion insert(const comm::Comm& comm, const scene::Scene& scene, const scene::Ownership& ownership,
                               const LayerRegion& region, particles::Store& store,
                               const std::function<void()>& between_volleys = {});

/// The trial of a particle: a uniform position with the whole sphere inside region and container (any lateral position
/// on periodic axes), evenly over where it fits. [m]
[[nodiscard]] Vec3 trial(const scene::Scene& scene, const LayerRegion& region, std::uint64_t particle, double radius,
                         std::uint32_t attempt);

/// True if two spheres overlap, by the one formula used everywhere in this module (shortest image on periodic axes).
[[nodiscard]] bool overlap(const geometry::Container& box, const Vec3& a, double ra, const Vec3& b, double rb);

}  // namespace packmpi::rsa
