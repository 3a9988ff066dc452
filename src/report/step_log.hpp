/// The time series of a run, NAME.steps.csv.
#pragma once
#include <cstdint>
#include <memory>
#include <string>

#include "comm/comm.hpp"
#include "disk/files.hpp"
#include "report/record.hpp"

namespace packmpi::report {

/// One row of NAME.steps.csv.
struct StepRow {
  std::int32_t layer = 0;
  std::int64_t step = 0;  ///< since the beginning of the run
  double time = 0.0;      ///< [s] simulated
  std::int64_t particles = 0;
  double kinetic_energy = 0.0;     ///< [J]
  double max_speed = 0.0;          ///< [m/s]
  double top = 0.0;                ///< [m]
  double mean_height = 0.0;        ///< [m] mean height of the moving particles' centres
  double max_force = 0.0;          ///< [N]
  std::int64_t rebuilds = 0;       ///< so far; depends on the ranks
  std::int64_t moving = 0;         ///< particles that are not frozen; all that follows is theirs
  double rotational_energy = 0.0;  ///< [J] part of the kinetic energy
  double potential_energy = 0.0;   ///< [J] m g times the height of the centres
  double elastic_energy = 0.0;     ///< [J] of pairs and walls
  double dissipated = 0.0;         ///< [J] given to them at insertion, less kinetic, potential and elastic
  Vec3 momentum{};                 ///< [kg m/s]
};

/// NAME.steps.csv, written row by row by rank 0 (a header line names columns and units). Rows that cannot be written (a
/// full disk) wait in memory until they can: a warning tells it.
class StepLog {
 public:
  /// Collective. A new series; if `goes_on`, that of a run that goes on: what `mark` says is kept, what was written
  /// after it is cut off, a torn row too. If the file is missing, shorter, or another one, a warning says so, it
  /// becomes PATH.old, and a new series begins here. `mark` follows all rows from now on, on all ranks alike, and must
  /// outlive this. Error(io_failure) on all ranks.
  StepLog(const comm::Comm& comm, const std::string& path, SeriesMark& mark, bool goes_on);
  void append(const StepRow& row);  ///< every rank alike; local
  /// Local, rank 0: rows that wait are written if they can be, and all are on the disk to stay.
  void sync();
  /// Collective. Closes it. How many rows are in the file, on the disk to stay; if fewer than mark.rows, a warning has
  /// said why.
  [[nodiscard]] std::int64_t close();

 private:
  void begin();
  [[nodiscard]] bool go_on();
  void flush();

  const comm::Comm* comm_;
  std::string path_;
  SeriesMark& mark_;
  std::unique_ptr<disk::Descriptor> file_;  // rank 0
  std::int64_t end_ = 0;                    // [bytes] of the file that are whole rows
  std::string waiting_;                     // rows that could not be written yet
  std::int64_t lost_ = 0;                   // rows, once too many wait
  std::int64_t safe_ = 0;                   // rows that were in the file at the last sync
  bool warned_ = false;
};

}  // namespace packmpi::report
