/// Keeps a run: writes its checkpoints when they are due, and ends it when it is told to.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

#include "base/patience.hpp"
#include "base/timer.hpp"
#include "base/types.hpp"
#include "run/bed.hpp"
#include "run/files.hpp"
#include "run/journal.hpp"
#include "run/options.hpp"
#include "run/restart.hpp"
#include "tables/rhythm.hpp"

namespace packmpi::run {

/// Watches the clock, signals, the STOP file and the limits of a run. Rank 0 decides; a signal may reach any rank. All
/// it is given must outlive it.
class Keeper {
 public:
  Keeper(Bed& bed, Journal& journal, const Files& files, const Options& options, const Origin& origin);

  /// Steps to make until the next look(); the same on all ranks, at least 1.
  [[nodiscard]] std::int64_t steps_to_look() const;
  /// Collective. Writes a checkpoint if one is due or asked for. Throws Error(stopped_early) on all ranks after writing
  /// one, if the run is to end; Error(numerical_failure), and writes nothing, if the state is not valid. A checkpoint
  /// that cannot be written is an error only then; else it is a warning, and the old ones stay. Cost: one reduction.
  void look();
  /// Collective. The same at the end of a layer, where a checkpoint is due sooner.
  void layer_ended();
  /// Collective. Between the volleys of an insertion: a checkpoint asked for waits for the layer to be there; if the
  /// run is to end, what the layer has inserted, all owned particles from slot `before` on, is dropped, and
  /// stopped_early thrown after a checkpoint: insertion is a function of the seed, and begins anew.
  void look_while_inserting(LocalIndex before);
  /// Collective. The pack is on the disk: removes the checkpoints.
  void finished();

 private:
  enum class Reason : std::int64_t { none, signal, stop_file, time_limit, step_limit };
  struct Due {
    bool checkpoint;
    Reason stop;
  };
  [[nodiscard]] Due agree(bool due);
  void look(bool due);
  [[nodiscard]] bool due_by_clock(double least) const;
  [[nodiscard]] Reason reason_to_stop();
  [[nodiscard]] bool out_of_time() const;
  void write();
  void keep_going_without(const std::string& words);
  [[noreturn]] void stop(Reason reason);

  Bed& bed_;
  Journal& journal_;
  const Files& files_;
  StopFile stop_file_;
  tables::Rhythm rhythm_;
  double limit_ = 0.0;      // [s] since the start; rank 0; infinite: none
  std::int64_t last_step_;  // of the last checkpoint, or of the start
  std::int64_t step_limit_;
  std::int64_t serial_;
  std::size_t slot_;
  Stopwatch watch_;
  double written_at_ = 0.0;                         // [s]
  double looked_at_ = 0.0;                          // [s]
  double longest_write_ = 0.0, longest_gap_ = 0.0;  // [s]
  bool kept_ = false;                               // the state after last_step_ is on the disk
  bool waits_ = false;                              // a checkpoint that was asked for during an insertion
};

}  // namespace packmpi::run
