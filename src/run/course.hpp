/// Where Algorithm 1 stands, beside the particles and the record.
#pragma once
#include <cstdint>

#include "pack/checkpoint.hpp"
#include "report/record.hpp"

namespace packmpi::run {

/// How far a part has come: with the bed, all there is to know to go on with it.
struct Course {
  std::int64_t done = 0;         ///< steps
  double phi_before = 0.0;       ///< solid fraction from which the compaction rate is measured, once known
  double mean_height = 0.0;      ///< [m] of the moving particles at the last look, stop = "settled" only
  std::int64_t calm_since = -1;  ///< step of the look since which the criteria hold; -1: they do not
  double phi_calm = 0.0;         ///< solid fraction at that look
  unsigned met = 0;              ///< criteria that this process has told of, a bit each; not in checkpoints
};

/// What is being done and how far it is. With Bed and RunRecord, all that steers a run.
struct Stand {
  pack::Phase phase = pack::Phase::insertion;
  report::LayerRow row{};  ///< of the layer that settles
  Course course{};
};

}  // namespace packmpi::run
