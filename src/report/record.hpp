/// What a run reports about itself: target versus achieved, per layer and in all; written to the pack, NAME.json and
/// the screen.
#pragma once
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/digest.hpp"
#include "base/types.hpp"
#include "confine/outcome.hpp"
#include "observe/composition.hpp"
#include "observe/measure.hpp"
#include "observe/rest.hpp"
#include "observe/size_match.hpp"

namespace packmpi::report {

/// One row of the per-layer table.
struct LayerRow {
  std::int64_t inserted = 0;       ///< particles
  std::int64_t total = 0;          ///< particles after it
  std::int64_t attempts = 0;       ///< trials
  double target_fraction = 0.0;    ///< phi_0
  double achieved_fraction = 0.0;  ///< solid volume inserted / region volume
  double region_bottom = 0.0;      ///< [m] T
  double height = 0.0;             ///< [m] after settling, by the scene's height rule
  double top = 0.0;                ///< [m] highest particle top
  double duration = 0.0;           ///< [s] simulated
  std::int64_t steps = 0;
  double kinetic_per_mgd = 0.0;  ///< mean kinetic energy / (m g d) of a mean particle at the end of the layer
  double max_overlap = 0.0;      ///< largest overlap / smaller radius
  double coordination = 0.0;     ///< mean touching particles
  std::string stop_reason;       ///< "duration", "settled", "inserted", "taken over"
};

/// What NAME.steps.csv holds, so that a run that goes on knows whether the series is whole.
struct SeriesMark {
  std::int64_t rows = 0;             ///< since the beginning of the run
  std::int64_t in_file = 0;          ///< of them in the file: fewer, once a series was found that was not whole
  std::uint64_t digest = fnv_start;  ///< of those, without the column of rebuilds, which depends on the ranks
};

/// The final audit: what must be true of a pack.
struct Audit {
  std::int64_t expected = 0, found = 0;  ///< particles; lost = expected - found
  std::int64_t non_finite = 0;
  double worst_overlap = 0.0;           ///< overlap / smaller radius
  double worst_wall_penetration = 0.0;  ///< penetration / radius
  std::int64_t outside = 0;             ///< centres outside the container
};

/// A measure of rest and its limit.
struct Criterion {
  const char* name;         ///< as in [rest]
  const char* words;        ///< for people
  double value = 0.0;       ///< [-]
  double limit = 0.0;       ///< of the value's distance from the target; see asked()
  double target = 0.0;      ///< 0: the less the better
  bool of_overlap = false;  ///< a matter of stiffness, not of time
  [[nodiscard]] bool asked() const noexcept { return limit < 1e9; }  ///< a limit so far off is none
  [[nodiscard]] bool met() const noexcept { return !asked() || std::abs(value - target) < limit; }
};

/// The density that was asked for, and what layers were filled in with. Empty without a target.
struct DensityTarget {
  std::string key;                                 ///< that named it; "": no target
  double fraction = 0.0, tolerance = 0.0;          ///< [-] solid fraction of the bulk
  bool confined = false;                           ///< it holds under the stress of [confinement]
  std::vector<double> friction, rolling_friction;  ///< [-] of each layer while it settled
  /// [-] solid fraction of the buried part of the bed after each layer; 0: nothing was buried deep enough
  std::vector<double> buried;

  [[nodiscard]] bool on() const noexcept { return !key.empty(); }
};

/// A number that every rank has its own of, rank after rank.
struct RankNumbers {
  std::string name, unit;  ///< "" for counts
  std::vector<std::int64_t> of_rank;

  [[nodiscard]] std::int64_t sum() const;
  [[nodiscard]] std::int64_t max() const;  ///< 0 if there are none
  [[nodiscard]] double imbalance() const;  ///< max / mean; 1 if all are 0
};

/// Everything about a run but its particles. Quantities marked (*) are the same on any number of ranks.
struct RunRecord {
  // targets
  std::string name, scene_file, effective_input;
  std::uint64_t seed = 0;
  int dimension = 3;
  std::string shape = "box";  ///< of the container, as the scene calls it
  Vec3 size{};                ///< [m] container; of another shape than a box the prism around it
  double bottom_diameter = 0.0, top_diameter = 0.0, inner_diameter = 0.0;  ///< [m] of vessels that have them
  double bottom_width = 0.0, top_width = 0.0;                              ///< [m] of a trapezium
  double target_height = 0.0;                                              ///< [m] H_d
  double target_fraction = 0.0;                                            ///< phi_0 of each insertion
  std::int64_t target_particles = 0;                                       ///< 0: as many as the height takes
  bool insertion_alone = false;  ///< target_fraction is that of the container, and the height no target
  std::string start;             ///< what was taken over from another pack, and what not; "": there was none
  double target_mean_radius = 0.0, target_sd_radius = 0.0, target_min_radius = 0.0, target_max_radius = 0.0;  ///< [m]
  DensityTarget density;
  // achieved (*)
  std::int64_t particles = 0;
  double height = 0.0, top = 0.0;  ///< [m]
  double phi = 0.0;                ///< solid fraction below H_d (CC16 eq. 22)
  double phi_bulk = 0.0;           ///< solid fraction of the bulk
  confine::Outcome confined;       ///< [confinement]
  observe::Bulk bulk;              ///< [m] its bounds
  double compaction_rate = 0.0;    ///< d phi_bulk / dt at the end [1/s]
  observe::Rest rest;              ///< how near to rest, and the contact network
  double kinetic_energy = 0.0;     ///< [J]
  double floor_force = 0.0;        ///< [N]
  double weight = 0.0;             ///< [N] m g of all particles
  double mean_radius = 0.0, sd_radius = 0.0, min_radius = 0.0, max_radius = 0.0;  ///< [m]
  observe::SizeMatches sizes;                                                     ///< with their targets
  observe::Composition composition;                                               ///< empty with one component
  std::vector<double> component_masses;                                           ///< [kg] of each, as asked for
  double time_step = 0.0;                                                         ///< [s]
  std::int64_t steps = 0;
  double duration = 0.0;  ///< [s] simulated
  std::int64_t particle_steps = 0;
  std::int64_t relaxations = 0;           ///< final stages, in which all particles move; more than one if the bed sank
  std::int64_t relaxation_steps = 0;      ///< of all of them, part of steps
  double height_before_relaxation = 0.0;  ///< [m] before the last of them; 0 if there was none
  bool reached = false;                   ///< target height reached, or the number of particles
  std::string stop_reason;
  bool targets_met = false;  ///< nothing is in `missed`
  std::vector<LayerRow> layers;
  Audit audit;
  std::vector<Criterion> criteria;  ///< of rest
  std::vector<std::string> missed;  ///< targets, a sentence each with what to change
  // how (not the same from run to run)
  int ranks = 1;
  std::string decomposition, version, git, compiler, architecture;
  std::string petsc_options;  ///< all that PETSc had, whoever gave them
  double wall_seconds = 0.0;
  std::uint64_t pack_seal = 0;                            ///< of the pack, once it is written (pack::seal_of())
  std::int64_t steps_here = 0;                            ///< of this process: not those before a restart
  std::int64_t series_rows = 0, series_rows_in_file = 0;  ///< of NAME.steps.csv: told, and there
  std::int64_t series_rows_lost = 0;                      ///< that this process could not write
  double particle_steps_per_second = 0.0;
  double bytes_per_particle = 0.0;  ///< worst rank
  // what it cost, on rank 0; empty on the others
  std::vector<RankNumbers> counters;  ///< counts: the same in every run on as many ranks
  std::vector<RankNumbers> costs;     ///< times, memory

  /// Whether the density that is ordered is that of the pack before its lid came (target.state = "filled").
  [[nodiscard]] bool density_is_before_stress() const noexcept { return confined.on && !density.confined; }
};

/// All that was missed, with `between` between; empty: nothing.
[[nodiscard]] std::string missed_words(const RunRecord& record, std::string_view between);
/// The numbers of that name, or null.
[[nodiscard]] const RankNumbers* find(const std::vector<RankNumbers>& all, const std::string& name);
/// Steps of moving particles over those of all, the frozen included, by the counters; 1 without.
[[nodiscard]] double moving_share(const RunRecord& record);

}  // namespace packmpi::report
