/// The dynamics between two insertions, and the final stage.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "run/attendant.hpp"
#include "run/bed.hpp"

namespace packmpi::run {

/// A layer's dynamics (the newest layers move, at scene.settling) or the final stage (all move, at scene.last(), after
/// hardening).
enum class Part { layer, relaxation };

/// What a part came to.
struct Settled {
  std::int64_t steps = 0;
  double seconds = 0.0;          ///< simulated
  double compaction_rate = 0.0;  ///< change of phi_bulk a second at its end [1/s]
  bool early = false;            ///< the criteria of stop = "settled" held before the duration was over
};

/// Collective. Integrates a part of the run from bed.progress.now on to its end; `attendant` may end it, by an
/// Error, before. What is frozen adds nothing to the compaction rate.
[[nodiscard]] Settled settle(Bed& bed, Attendant& attendant, Part part);

/// Steps of a part at most; fewer if stop = "settled" ends it. Local.
[[nodiscard]] std::int64_t steps_of(const scene::Scene& scene, Part part);

/// Young's moduli of the stairs from `soft` to `hard`, equal in ratio: stair k lasts from ramp_start(k) on. Square
/// roots only, so the same bits on any machine. `hard` alone if it is not harder.
[[nodiscard]] std::vector<double> hardening(double soft, double hard);

}  // namespace packmpi::run
