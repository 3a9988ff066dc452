/// What a bed of several components is made of, where, and how well it is mixed. Reads only.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "observe/measure.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::observe {

/// Of one component in the whole bed.
struct ComponentPart {
  std::string name;
  std::int64_t count = 0;
  double volume = 0.0, mass = 0.0;  ///< [m3] as spheres, [kg]; volume to 2^-32 of the largest sphere
  double lacey = 0.0;               ///< [-] Lacey's index of mixing in the bulk, 1: as if by chance, 0: unmixed; or NaN
  double lacey_error = 0.0;         ///< [-] standard error (jackknife over cells)
};

/// Between a stratum and the next one above.
struct StratumBoundary {
  std::string below, above;
  double wanted = 0.0;  ///< [m] where it was to be; 0: strata are by mass
  double height = 0.0;  ///< [m] below it there is as much solid, spheres cut, as there is of all strata below
  double mixed = 0.0;   ///< [m] depth of solid of each side that lies on the other
};

struct Composition {
  std::vector<ComponentPart> parts;
  std::vector<StratumBoundary> boundaries;
  double slab = 0.0;                        ///< [m] height of the slabs, from the floor
  std::vector<std::vector<double>> shares;  ///< [slab][component] of the solid volume, by centres; 0 in an empty slab
  std::int64_t cells = 0;                   ///< of Lacey's index
  double cell = 0.0;                        ///< [m] their height
};

/// Lacey's index M = (s0^2 - s^2) / (s0^2 - sr^2) from the number of particles of cells, and of those among them that
/// are of the component: s^2 the variance of the share between cells, weighted by particles; s0^2 = p (1 - p) unmixed;
/// sr^2 that of mixing by chance (Lacey, J. Appl. Chem. 4, 257, 1954). NaN where that cannot be told. Pure.
struct Lacey {
  double index, error;
};
[[nodiscard]] Lacey lacey(std::span<const std::int64_t> all, std::span<const std::int64_t> own);

/// Collective; same bits on any ranks. `stratum`: of each owned particle, in slot order; empty: no strata. Without
/// several components: empty.
[[nodiscard]] Composition composition(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                                      const Bulk& bulk, std::span<const std::int32_t> stratum);

}  // namespace packmpi::observe
