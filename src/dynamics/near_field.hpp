/// The near field of CC16 eqs. (5)-(6): an attraction and a repulsion by powers of the distance, up to a cut-off.
#pragma once
#include <cstdint>

#include "neighbor/lists.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::dynamics {

/// d^-exponent for d > 0. Integers and halves are products, one root and one quotient, so the bits are the same on
/// every machine; other exponents are std::pow, whose last bit belongs to the C library. Cost: O(log exponent).
[[nodiscard]] double inverse_power(double d, double exponent);

/// Add to both owned ends of each pair nearer than the cut-off, f = (alpha1 d^-beta1 - alpha2 d^-beta2) n on the first
/// and -f on the second; n from first to second, so alpha1 attracts. Coinciding centres have no n and are skipped.
/// accumulators   [force quanta] slot i at i * accumulators_of(layout), for all owned; to be the step kernel's ring
/// False if a force left the range of the integer sums (max_quanta) or is not finite: the accumulators are garbage
/// then. Precondition: the scene has a near field. Local. Cost: O(pairs).
[[nodiscard]] bool add_near_field(const scene::Scene& scene, const particles::Store& store,
                                  const neighbor::PairList& pairs, std::int64_t* accumulators);

}  // namespace packmpi::dynamics
