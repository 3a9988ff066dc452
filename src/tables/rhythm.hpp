/// How often a run writes checkpoints.
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

namespace packmpi::tables {

/// By wall time or by steps; both 0: only when the run is told to stop.
struct Rhythm {
  double seconds = 0.0;    ///< [s] of wall time
  std::int64_t steps = 0;  ///< time steps
};

/// The meaning of checkpoint.every: "10min", "90 s", "2h", "5000 steps", "off". None: no such words. Local.
[[nodiscard]] std::optional<Rhythm> rhythm_of(std::string_view every);

}  // namespace packmpi::tables
