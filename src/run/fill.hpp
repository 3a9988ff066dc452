/// The loop of Algorithm 1.
#pragma once
#include "run/attendant.hpp"
#include "run/bed.hpp"

namespace packmpi::run {

/// Collective. Fills the bed, from where bed.progress says: layers until the scene's height is reached, and the final
/// stage; more layers if the bed sank in it. Bounded. With bed.progress.filling on, layers have its friction while they
/// settle, and what they measure corrects it. Throws Error(numerical_failure) on all ranks, and what the attendant
/// does.
void fill(Bed& bed, Attendant& attendant);

}  // namespace packmpi::run
