/// How a step visits the owned slots of a rank so that ghosts travel while it works.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "neighbor/halo.hpp"
#include "neighbor/lists.hpp"

namespace packmpi::neighbor {

/// A part of a step: the owned slots from the end of the leg before up to `end`, the pairs whose first is one of them
/// and their walls.
struct Leg {
  LocalIndex end;
  std::int64_t pairs_end, walls_end;  ///< in the lists
  std::array<bool, 2> needs;          ///< by half: its ghosts are read from this leg on
  std::array<bool, 2> sends;          ///< by half: after this leg nobody changes what is sent of it
};

/// The legs of a step with these lists, ascending; at least one, the last ends at `owned`. Each half is needed before
/// it is sent, and the first is sent before the second. Few legs: each cuts a block of pairs short, and to call MPI in
/// between for no other reason than to let it work cost more than it gained. Cost: O(pairs) at worst.
[[nodiscard]] std::vector<Leg> make_sweep(LocalIndex owned, const PairList& pairs, const WallList& walls,
                                          const Halo& halo);

}  // namespace packmpi::neighbor
