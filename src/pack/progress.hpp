/// Where a run is: all that steers it beside its particles. Checkpoints contain it as a whole.
///
/// To add a field: a line in a struct here, and its name in run_state.cpp, which does not compile without it. No other
/// place copies fields; what is in none of these structs does not survive a restart.
#pragma once
#include <cstdint>
#include <vector>

#include "base/types.hpp"
#include "confine/state.hpp"
#include "control/filling.hpp"
#include "control/mixing.hpp"
#include "report/record.hpp"

namespace packmpi::pack {

/// What a run does next.
enum class Phase {
  insertion,  ///< of a layer, or the end
  settling,   ///< the newest layer is inserted and goes on settling
  relaxation  ///< the final stage goes on
};

/// Kinetic damping of a bed that swings in its final stage.
struct Swing {
  bool on = false;
  double kinetic_energy = 0.0;  ///< [J] when last looked at, if no particle was stopped then
};

/// How far the present phase has come: a new phase begins with a new one.
struct PhaseProgress {
  Phase phase = Phase::insertion;
  report::LayerRow row{};        ///< of the layer that settles, as far as known
  std::int64_t done = 0;         ///< steps
  double phi_before = 0.0;       ///< solid fraction from which the compaction rate is measured, once known
  double mean_height = 0.0;      ///< [m] of the moving particles at the last look for rest (stop = "settled")
  std::int64_t calm_since = -1;  ///< step of the look since which the criteria of stop = "settled" hold; -1: none
  double phi_calm = 0.0;         ///< solid fraction at that look
  std::int64_t told = 0;         ///< criteria of rest that the log has told of, a bit each
  Swing swing{};
};

/// The same on all ranks.
struct Progress {
  std::vector<GlobalId> first_ids;  ///< of each layer inserted so far
  GlobalId count = 0;               ///< particles
  GlobalId moving_from = 0;         ///< particles with smaller ids are frozen
  /// [J] kinetic and potential, as the moving particles were given it: at insertion, less what the frozen took away
  double energy_given = 0.0;
  std::int64_t steps = 0;                 ///< since the beginning of the run
  std::int64_t relaxation_steps = 0;      ///< of them, in final stages
  std::int64_t particle_steps = 0;        ///< of moving particles, on all ranks
  std::vector<report::LayerRow> layers;   ///< settled
  double height = 0.0;                    ///< [m] of the bed, as last measured
  double compaction_rate = 0.0;           ///< [1/s] at the end of the last phase
  std::int64_t relaxations = 0;           ///< final stages begun and finished
  double height_before_relaxation = 0.0;  ///< [m] before the last of them; 0 if there was none
  report::SeriesMark series;              ///< NAME.steps.csv
  control::Filling filling;               ///< towards a density; of no meaning without a target
  confine::State confined;                ///< lid and sides; of no meaning before they move
  control::Mixing mixing;                 ///< of no meaning with one component
  PhaseProgress now;
};

}  // namespace packmpi::pack
