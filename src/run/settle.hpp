/// The dynamics between two insertions, and the final stage.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "run/journal.hpp"
#include "run/pile.hpp"

namespace packmpi::run {

/// A layer's dynamics (the newest layers move, at scene.settling) or the final stage (all move, at scene.last(), after
/// hardening).
enum class Part { layer, thaw };

/// How far a part has come: with the pile, all there is to know to go on with it.
struct Course {
  std::int64_t done = 0;         ///< steps
  double phi_before = 0.0;       ///< solid fraction from which the creep is measured, once known
  double mean_height = 0.0;      ///< [m] of the moving particles at the last look, stop = "settled" only
  std::int64_t calm_since = -1;  ///< step of the look since which the criteria hold; -1: they do not
  double phi_calm = 0.0;         ///< solid fraction at that look
};

/// What a part came to.
struct Settled {
  std::int64_t steps = 0;
  double seconds = 0.0;  ///< simulated
  double creep = 0.0;    ///< change of phi_bulk a second at its end [1/s]
  bool early = false;    ///< the criteria of stop = "settled" held before the duration was over
};

/// Collective. Integrates a part of the run from `course` on to its end. What is frozen adds nothing to the creep.
[[nodiscard]] Settled settle(Pile& pile, Journal& journal, Part part, Course& course);

/// Young's moduli of the stairs from `soft` to `hard`, equal in ratio: stair k lasts from ramp_start(k) on. Square
/// roots only, so the same bits on any machine. `hard` alone if it is not harder.
[[nodiscard]] std::vector<double> hardening(double soft, double hard);

}  // namespace packmpi::run
