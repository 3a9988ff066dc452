/// Whether a run is told to end, before it has anything that a checkpoint could keep.
#pragma once
#include <string>

#include "base/timer.hpp"

namespace packmpi {

/// [s] from now until a run has to end: after `hours`, if above 0, or at the end of the job's time if Slurm tells;
/// infinite: no limit. Local.
[[nodiscard]] double seconds_allowed(double hours);

/// Signals, the STOP file and the limits of time, while the samples of a target are made: each rank makes its own and
/// looks for itself. Local.
class Patience {
 public:
  Patience(std::string stop_file, double hours);
  /// Throws Error(stopped_early) if the run is to end. Cost: a clock, and once a second a look for the file.
  void look();

 private:
  std::string stop_file_;
  double limit_;  // [s] since then
  Stopwatch watch_;
  double seen_at_ = 0.0;  // [s] last look for the file
};

}  // namespace packmpi
