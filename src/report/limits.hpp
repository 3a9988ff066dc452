/// The loosest and the densest state of a scene, as `packmpi limits` tells them: on the screen and as JSON.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace packmpi::report {

/// One of the two states.
struct State {
  double friction = 0.0, wall_friction = 0.0;              ///< [-] while filling
  double rolling_friction = 0.0, twisting_friction = 0.0;  ///< [-] likewise
  std::vector<double> fractions;                           ///< [-] solid fraction of the bulk at the end, a seed each
  std::vector<double> coordinations;                       ///< [-] likewise

  [[nodiscard]] double mean() const;   ///< of the fractions
  [[nodiscard]] double error() const;  ///< standard error of the mean; 0 of one seed
};

struct LimitsReport {
  std::string scene_file;
  std::vector<std::uint64_t> seeds;
  bool whole = false;        ///< the scene itself was filled, not a sample of it
  double particles = 0.0;    ///< of the sample, roughly
  std::vector<double> size;  ///< [m] of the sample
  double scale = 1.0;        ///< by which its solid fractions were multiplied, for side walls that it has not
  std::string protocol;      ///< how the states were made, in words
  State densest, loosest;
};

/// Stable key order, units in `units`. Local.
[[nodiscard]] std::string to_json(const LimitsReport& limits);
/// A table of at most 100 columns. Local.
[[nodiscard]] std::string to_table(const LimitsReport& limits);

}  // namespace packmpi::report
