/// The record as JSON, as a table on the screen, and the time series.
#pragma once
#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

#include "comm/comm.hpp"
#include "report/record.hpp"

namespace packmpi::report {

/// The record as JSON text (2-space indent, stable key order, 17 digits). Local.
[[nodiscard]] std::string to_json(const RunRecord& record);

/// "Target versus achieved" and the layers as a plain-text table of at most 100 columns. Local.
[[nodiscard]] std::string to_table(const RunRecord& record);

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

/// NAME.steps.csv, written row by row by rank 0 (a header line names columns and units); each row is on its way to the
/// disk when append() returns. A failed write is told at close().
class StepLog {
 public:
  /// Collective. A new series; or, if `last_step` is given, the one that is there up to and with that step, which goes
  /// on. Error(io_failure) on all ranks.
  StepLog(const comm::Comm& comm, const std::string& path, std::optional<std::int64_t> last_step = {});
  void append(const StepRow& row);  ///< local; no-op but on rank 0
  void close();                     ///< collective; Error(io_failure) on all ranks

 private:
  void flush();

  const comm::Comm* comm_;
  std::string path_;
  std::ofstream file_;
  int failure_ = 0;  // errno of the first write that failed
};

}  // namespace packmpi::report
