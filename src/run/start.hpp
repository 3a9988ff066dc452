/// Going on from a pack that is there: [start].
#pragma once
#include <string>

#include "input/input.hpp"
#include "run/bed.hpp"

namespace packmpi::run {

/// Puts the particles of the pack that the scene starts from into an empty bed, on any number of ranks: ids, positions,
/// radii, velocities, spins, layers, to the bit; what contacts remember if the pack has it and forces are the same. If
/// they are others than in the pack's scene, the final stage comes next, even if no layer does. Collective. Throws
/// Error(bad_input) on all ranks if the pack does not fit: container, radii, overlaps deeper than start.overlap_limit;
/// Error(io_failure) if it is damaged. Cost: one reading of the pack, shared by the ranks.
void take_over(Bed& bed);

/// Takes over what [start] names, as a run would, and lets it go: throws what is wrong with it. Without [start]:
/// nothing. Collective; as dear as the pack that is read.
void check_start(const comm::Comm& comm, const scene::Scene& scene);

}  // namespace packmpi::run
