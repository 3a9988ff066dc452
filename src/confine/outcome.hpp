/// What a specimen under a lid has come to.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "comm/comm.hpp"
#include "confine/state.hpp"
#include "neighbor/neighborhood.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::confine {

/// What [confinement] came to; stresses in Pa, compression positive. Not on: there was none.
struct Outcome {
  bool on = false;
  double vertical = 0.0, lateral = 0.0, tolerance = 0.0;  ///< asked for; lateral 0: not asked for
  double seconds = 0.0;                                   ///< [s] simulated under the lid
  double lid = 0.0;                                       ///< [m] its height
  std::vector<double> size;                               ///< [m] lateral extents under it
  double on_lid = 0.0, on_floor = 0.0;
  std::vector<double> on_sides;     ///< on the high walls; of periodic axes 0
  std::vector<double> of_contacts;  ///< axis by axis, the vertical last
  double vertical_at_rest = 0.0;    ///< see Stress
  double ratio = 0.0;               ///< lateral over vertical stress of the contacts: K0 if no side has moved
  std::array<double, 3> misfit{};   ///< of lid, contacts, sides: see measure()
  double phi_before = 0.0;          ///< solid fraction of the bulk before the lid came
  double work = 0.0;                ///< [J] of lid and sides
  std::int64_t steps = 0;

  [[nodiscard]] double worst() const noexcept;  ///< misfit
};

/// Collective, exact; from current lists and ghosts. Off before the lid is there. Misfits are over the stress asked
/// for, 0 where it is there: of the stress on the lid; of the vertical stress of the contacts, from what lid, weight
/// and side walls demand; and the worst of the sides, of the stress on walls that move or of the contacts along
/// periodic axes. Cost: about three steps.
[[nodiscard]] Outcome measure(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                              const neighbor::Neighborhood& neighborhood, const State& state);

}  // namespace packmpi::confine
