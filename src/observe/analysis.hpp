/// What a settled pack is like inside: profiles, local density, contacts, forces, order. The same on any number of
/// ranks.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "comm/comm.hpp"
#include "neighbor/neighborhood.hpp"
#include "observe/composition.hpp"
#include "observe/measure.hpp"
#include "observe/rest.hpp"
#include "observe/size_match.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::observe {

/// A quantity in equal bins: values[k] belongs to [from + k width, from + (k + 1) width).
struct Profile {
  double from = 0.0;
  double width = 0.0;
  std::vector<double> values;
};

/// A pack to be analysed. The lists of `neighborhood` are those of the scene, and its near pairs reach to `range`.
struct Specimen {
  const comm::Comm& comm;
  const scene::Scene& scene;
  const particles::Store& store;
  const neighbor::Neighborhood& neighborhood;
  double range;    ///< [m] of the near pairs
  double surface;  ///< [m] surface_height()
  Bulk bulk;       ///< measures "of the bulk" take the particles whose centres are there
  /// What the contacts remember is in the neighborhood, if the scene's friction has memory. Without it forces lack
  /// their springs, and nothing can be said of rest.
  bool springs = true;
};

/// Collective.
[[nodiscard]] Specimen specimen_of(const comm::Comm& comm, const scene::Scene& scene, const particles::Store& store,
                                   const neighbor::Neighborhood& neighborhood, double range);

/// Solid fraction in slabs a quarter of the mean diameter thick: along the vertical of the whole pack, exact; along a
/// lateral axis of the bulk, whose cut particles count as a whole. Collective.
[[nodiscard]] Profile density_profile(const Specimen& pack, int axis);

/// Solid fraction of the bulk of a round vessel by the distance from its wall, in shells a twentieth of a mean diameter
/// thick (the last, around the axis, what is left), of an annulus from the inner one, too; and of all that is at least
/// `from_walls` [m] away from its side walls, three mean diameters. Spheres are cut by the shells and by the bulk's
/// planes, to 1e-9 of a radius cubed; discs of 2D likewise. In a mesh by the distance from the nearest place of the
/// surface, floor and lid included, and by points (observe/radial_points.hpp). Collective. Cost: about 0.1 ms a
/// particle.
struct RadialProfile {
  Profile profile;     ///< empty: of a box, or of no bulk
  Profile from_inner;  ///< of an annulus
  double from_walls = 0.0;
  double core = 0.0;  ///< 0: the vessel is too narrow for one
};
[[nodiscard]] RadialProfile radial_profile(const Specimen& pack);

/// Segregation: mean radius [m] by number in slabs three mean diameters thick up the pack (0 where there is none), and
/// the correlation of radius and height, -1 .. 1 (0 for equal radii). Collective.
struct Segregation {
  Profile mean_radius;
  double correlation = 0.0;
};
[[nodiscard]] Segregation segregation(const Specimen& pack);

/// Radial distribution g(r), r in mean diameters, bins of 1/50: pairs found over pairs in a gas of the same density.
/// Centres are those at least range from walls, floor and surface, so that every shell is whole. Collective.
struct PairDistribution {
  Profile g;
  std::int64_t centres = 0;  ///< 0: the pack is too small, and g is empty
};
[[nodiscard]] PairDistribution pair_distribution(const Specimen& pack);

using Tensor = std::array<std::array<double, 3>, 3>;  ///< rows; z is 0 in 2D

/// Contacts of the bulk. Fabric: mean of n n. Stress [Pa] (2D: N/m): sum of branch x force over the bulk's volume,
/// compression positive. Forces: the distribution of f_n / mean f_n, a density. Collective.
struct Forces {
  std::int64_t contacts = 0;
  Tensor fabric{};
  Tensor stress{};
  double mean_normal_force = 0.0;  ///< [N]
  Profile distribution;
};
[[nodiscard]] Forces forces(const Specimen& pack);

/// Order around the particles of the bulk, from neighbours nearer than 1.207 (r_i + r_j), the middle between the first
/// two shells of fcc. 2D: |psi_6| of a particle, and of all together. 3D: Steinhardt's q_4, q_6 and, by
/// common-neighbour analysis (Honeycutt & Andersen 1987), the shares that are fcc and hcp. Collective.
struct Order {
  std::int64_t counted = 0;
  double psi6 = 0.0, psi6_together = 0.0;
  double q4 = 0.0, q6 = 0.0;
  double fcc = 0.0, hcp = 0.0;
};
[[nodiscard]] Order order(const Specimen& pack);

/// Volume of a particle over that of its Voronoi cell (radical planes for unequal radii, walls cut) in the bulk. Cells
/// that particles beyond the range might cut are left out and counted. Collective.
struct LocalDensity {
  std::int64_t counted = 0, left_out = 0;
  double mean = 0.0, sd = 0.0;
  Profile distribution;  ///< a density
};
[[nodiscard]] LocalDensity local_density(const Specimen& pack);

/// All of it.
struct Analysis {
  std::int64_t particles = 0;
  double mean_diameter = 0.0;  ///< [m] of the scene
  SizeMatches sizes;
  Composition composition;       ///< without strata's boundaries; empty with one component
  std::vector<Profile> density;  ///< along x, y(, z)
  RadialProfile radial;          ///< of a round vessel
  Segregation segregation;
  PairDistribution pairs;
  bool springs = true;  ///< see Specimen
  Rest rest;            ///< only its overlaps and network without springs
  Forces forces;
  double floor_force = 0.0;  ///< [N]
  double weight = 0.0;       ///< [N]
  Order order;
  LocalDensity local;
};
/// Collective. Memory: about 600 bytes a particle beside the lists.
[[nodiscard]] Analysis analyse(const Specimen& pack);

}  // namespace packmpi::observe
