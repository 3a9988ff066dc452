/// The size distribution of a pack beside the one the scene asks for.
#pragma once
#include "comm/comm.hpp"
#include "particles/store.hpp"
#include "scene/size_curve.hpp"

namespace packmpi::observe {

/// Diameters [m] that so many percent (of the particles, or of their mass) do not exceed.
struct SizePoints {
  double d10 = 0.0, d30 = 0.0, d50 = 0.0, d60 = 0.0, d90 = 0.0;
  [[nodiscard]] double uniformity() const { return d10 > 0.0 ? d60 / d10 : 0.0; }               ///< Cu
  [[nodiscard]] double curvature() const { return d10 > 0.0 ? d30 * d30 / (d10 * d60) : 0.0; }  ///< Cc
};

/// By one weighting. `distance` is Kolmogorov's: the largest difference of the two curves.
struct SizeMatch {
  SizePoints target, achieved;
  double distance = 0.0;
};

struct SizeMatches {
  SizeMatch by_number, by_mass;
};

/// Collective; the same bits on any number of ranks and for any shares. The diameters got are those of particles: the
/// smallest that the percentage does not exceed. The distance is looked for at 16,000 radii (every 1/8192 of the asked
/// number and mass) and at each bend and jump: exact for classes, else at most 1.3e-4 too small. Masses are integers of
/// 2^-57 N of the largest. No particles: zeros. Cost: a sort of the radii here; memory: 16 bytes a particle and about a
/// megabyte; some 60 reductions.
[[nodiscard]] SizeMatches size_match(const comm::Comm& comm, const particles::Store& store,
                                     const scene::SizeCurve& curve);

}  // namespace packmpi::observe
