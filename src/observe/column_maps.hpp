/// What a pack is like from place to place on the floor: fields over lateral columns, written with the pack.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "comm/comm.hpp"
#include "dynamics/contact_law.hpp"
#include "observe/measure.hpp"

namespace packmpi::observe {

/// This rank's columns of the maps, ascending in number (x fastest); rank after rank they are all columns.
struct ColumnMaps {
  std::array<std::int64_t, 2> counts{1, 1};  ///< columns along x and y; 2D: one along y
  std::array<double, 2> widths{};            ///< [m]; 2D: of y 0
  std::vector<double> top;                   ///< [m] highest top of a particle whose centre lies in the column
  std::vector<double> solid_fraction;        ///< below H_d, of the particles whose centres lie in the column; 0 where
                                             ///< less than an eighth of the column is in a round vessel
  /// [Pa] (2D: [N/m]) vertical stress of the contacts below H_d that have their middle in the column (Love-Weber: sum
  /// of force times branch, vertical components, over the column's volume); compression is positive
  std::vector<double> vertical_stress;
};

/// Columns are four mean diameters wide or a little more; wider where there would be over 2^20 of them. The mean of
/// solid_fraction is Density::phi to rounding, the largest top is top(). Collective; sums are of whole numbers, so the
/// maps are the same on any number of ranks. Cost: O(particles + pairs), about two steps; 16 bytes a contact for the
/// while.
[[nodiscard]] ColumnMaps column_maps(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                                     const neighbor::PairList& pairs, const dynamics::StoredView& stored = {});
/// Columns of the maps of a scene. Local.
[[nodiscard]] std::int64_t map_columns(const scene::Scene& scene);

}  // namespace packmpi::observe
