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

/// What was taken over and what was not, "" if nothing was. Local.
[[nodiscard]] std::string taken_words(const scene::Scene& scene, const pack::Progress& progress);

/// Was this layer taken over? Its reason to stop says so.
[[nodiscard]] bool is_taken_over(const report::LayerRow& row);
/// Do contacts that were taken over lack what they should remember? Then rest cannot be judged before they bear again.
[[nodiscard]] bool lacks_springs(const scene::Scene& scene, const pack::Progress& progress);

}  // namespace packmpi::run
