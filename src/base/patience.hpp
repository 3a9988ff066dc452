/// Whether a run is told to end.
#pragma once
#include <string>

#include "base/timer.hpp"

namespace packmpi {

/// [s] from now until a run has to end: after `hours`, if above 0, or at the end of the job's time if Slurm tells;
/// infinite: no limit. Local.
[[nodiscard]] double seconds_allowed(double hours);

/// The file that ends a run. Local.
class StopFile {
 public:
  explicit StopFile(std::string path);
  /// Cost: a clock, and once a second a look for the file; false in between.
  [[nodiscard]] bool is_there();

 private:
  std::string path_;
  Stopwatch watch_;
  double seen_at_ = 0.0;  // [s] last look
};

/// Signals, the STOP file and the limits of time, where there is nothing that a checkpoint could keep. Local.
class Patience {
 public:
  Patience(const std::string& stop_file, double hours);
  /// Why the run is to end now; null: it is not.
  [[nodiscard]] const char* why_to_end();

 private:
  StopFile stop_file_;
  double limit_;  // [s] since then
  Stopwatch watch_;
};

}  // namespace packmpi
