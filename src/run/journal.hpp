/// What a run tells while it goes: progress, NAME.log, NAME.steps.csv.
#pragma once
#include <cstdint>
#include <initializer_list>
#include <string>

#include "base/log.hpp"
#include "base/timer.hpp"
#include "report/record.hpp"
#include "report/step_log.hpp"
#include "run/bed.hpp"

namespace packmpi::run {

/// Progress line with an estimate of the time left (a terminal: one line, rewritten; else a line now and then).
class Journal {
 public:
  /// Collective. Opens the time series at `steps_path`; after a restart, that of bed.progress.
  Journal(Bed& bed, const std::string& steps_path, bool quiet, bool restarted);

  void layer_inserted(const report::LayerRow& row);  ///< local
  /// Collective. A row of the step log, and progress; `share` is the part of the layer's (or the final stage's)
  /// duration done, 0 .. 1.
  void moment(double share);
  void layer_settled(const report::LayerRow& row);  ///< local
  void filling_begins() const;                      ///< local; what a target is going to be met by, if there is one
  void layer_measured(const control::Filling& filling) const;  ///< local
  void relaxation_started();                                   ///< local; what follows is the final stage
  void relaxation_not_needed();                                ///< local; the bed was at rest: there was no final stage
  void relaxed(double height, double duration);  ///< local; height [m] after the final stage, which took so long [s]
  /// Local. What was told so far is on the disk to stay: before a checkpoint that counts on it.
  void sync() { steps_.sync(); }
  /// Collective. Closes the time series; how many of its rows are in the file.
  [[nodiscard]] std::int64_t finish();

 private:
  void progress(double share, double kinetic_energy, double top);
  [[nodiscard]] double seconds_left(double share) const;
  void tell(const std::string& event, const std::string& line, std::initializer_list<log::Field> fields) const;

  const Bed& bed_;
  report::StepLog steps_;
  Stopwatch watch_;
  bool terminal_ = false;
  bool quiet_ = false;
  double last_shown_ = 0.0;
  double height_ = 0.0;  // [m] after the last settled layer
  int layers_done_ = 0;
  int layers_before_ = 0;  // settled before a restart
  bool relaxing_ = false;
};

}  // namespace packmpi::run
