/// What a scene will take, as `packmpi estimate` tells it: on the screen and as JSON.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/types.hpp"

namespace packmpi::report {

/// What a short bed of the scene did in memory, on each rank alone; the slowest of them.
struct Probe {
  std::int64_t particles = 0;
  std::int64_t steps = 0;
  double seconds = 0.0;                    ///< [s] of wall time, insertion and dynamics
  double particle_steps_per_second = 0.0;  ///< [1/s] of one rank
  double insertions_per_second = 0.0;      ///< [1/s] of one rank
};

/// A number that is known to lie between two others, most likely.
struct Count {
  std::int64_t value = 0, least = 0, most = 0;
};

/// What a target costs beside the run.
struct SearchCost {
  std::int64_t samples = 0;                        ///< at most
  std::int64_t particles = 0, particle_steps = 0;  ///< of one; at most
};

struct Estimate {
  std::string scene_file;
  std::string found;               ///< which of the three is the answer: "particles", "height" or "floor"
  bool round = false;              ///< a cylinder: size is its diameter twice, and its height
  bool other = false;              ///< neither that nor a box: only its height is found
  std::vector<double> size;        ///< [m] container.size, with what was found
  double layer_thickness = 0.0;    ///< [m] layers.thickness; fitted to the particles if those were given
  bool thickness_changed = false;  ///< it is not that of the scene
  double fraction = 0.0;           ///< solid fraction of the bed below its surface
  double fraction_error = 0.0;     ///< what it may be off by
  bool fraction_given = false;     ///< by the user
  std::int64_t a_layer = 0;        ///< particles
  Count layers, particles;
  double height = 0.0;     ///< [m] of the bed
  std::int64_t steps = 0;  ///< of time, relaxation included
  std::int64_t relaxation_steps = 0;
  std::int64_t confinement_steps = 0;  ///< about, part of steps; 0 without
  std::int64_t particle_steps = 0;     ///< sum over the steps of the particles that move
  double duration = 0.0;               ///< [s] simulated
  bool at_most = false;                ///< stop = "settled" may take fewer steps
  int ranks = 1;                       ///< asked
  std::int64_t most_ranks = 1;         ///< that the columns allow
  double ghosts = 0.0;                 ///< copies of other ranks' particles a rank holds, by its own
  std::int64_t settling_bytes = 0;     ///< memory of a rank while layers settle
  std::int64_t writing_bytes = 0;      ///< the same while a pack or a checkpoint is written
  std::int64_t pack_bytes = 0;         ///< NAME.hdf
  std::int64_t checkpoint_bytes = 0;   ///< each of two
  std::int64_t step_log_bytes = 0;     ///< NAME.steps.csv, about
  std::optional<SearchCost> search;    ///< of a target
  std::optional<Probe> probe;
  double seconds = 0.0;               ///< [s] wall time of the run; 0 without a probe
  std::vector<std::string> warnings;  ///< what is likely a mistake
};

/// Stable key order, units in `units`. Local.
[[nodiscard]] std::string to_json(const Estimate& estimate);
/// A table of at most 100 columns. Local.
[[nodiscard]] std::string to_table(const Estimate& estimate);

}  // namespace packmpi::report
