/// Solid fraction by the distance from the walls of a vessel of triangles.
#pragma once
#include "observe/analysis.hpp"

namespace packmpi::observe {

inline constexpr double shells_a_diameter = 20.0;  ///< mean diameters; of all radial profiles
inline constexpr double core_in_diameters = 3.0;   ///< from the walls

/// As radial_profile() by a million points, one at random in each of as many equal cells of the box around the bulk:
/// which are in the interior, how far from the surface, and which of them in a sphere. Shells with fewer than 400
/// points are left out; the standard error of one with n points is sqrt(phi (1 - phi) / n) or less. Collective; the
/// same on any number of ranks. Cost: about 3 us a point, over the ranks.
[[nodiscard]] RadialProfile radial_by_points(const Specimen& pack);

}  // namespace packmpi::observe
