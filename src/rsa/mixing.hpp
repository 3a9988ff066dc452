/// Of which components a layer is.
#pragma once
#include "comm/comm.hpp"
#include "control/mixing.hpp"
#include "rsa/insert.hpp"

namespace packmpi::rsa {

/// Collective. Chooses the portions of `region`, which is to have layers.fraction of its volume or what is left of its
/// stratum, such that what each component adds up to since the first layer is nearest to its share of what was asked
/// for: within half a particle of it. Goes on in `mixing` as if the layer were inserted. `fraction`: the bed's solid
/// fraction; 0: as expected. Cost: O(particles / ranks) draws.
void plan_layer(const comm::Comm& comm, const scene::Scene& scene, double fraction, control::Mixing& mixing,
                LayerRegion& region);

}  // namespace packmpi::rsa
