/// The finished bed under a lid: [confinement].
#pragma once
#include "run/attendant.hpp"
#include "run/bed.hpp"

namespace packmpi::run {

/// Collective. Brings the filled bed to the stress of its scene, from where bed.progress.confined says; nothing without
/// [confinement]. Moves *bed.box. Bounded. Throws what Bed::advance() and the attendant do.
void confine_bed(Bed& bed, Attendant& attendant);

}  // namespace packmpi::run
