/// A run between two steps, on the disk: everything that steers it, nothing that depends on the ranks (design:
/// doc/file_format.md).
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "particles/store.hpp"
#include "report/record.hpp"

namespace packmpi::pack {

inline constexpr std::int64_t checkpoint_version = 3;
inline constexpr std::int64_t oldest_checkpoint_version = 2;  ///< that can be read

/// What a run does next.
enum class Phase {
  insertion,  ///< of a layer, or the end
  settling,   ///< the newest layer is inserted and goes on settling
  relaxation  ///< the final stage goes on
};

/// What steers a run beside its particles. The same on all ranks.
struct RunState {
  std::int64_t serial = 0;      ///< of the checkpoint; a later one has a larger number
  std::string effective_input;  ///< of the run that wrote it
  std::string version, git;     ///< of the program that wrote it
  int dimension = 3;
  bool rotation = true;
  std::vector<GlobalId> first_ids;        ///< of each layer inserted so far
  GlobalId count = 0;                     ///< particles
  double energy_given = 0.0;              ///< [J] to the moving particles, for the step log
  std::int64_t steps = 0;                 ///< since the beginning of the run
  std::int64_t particle_steps = 0;        ///< on all ranks, since the beginning
  std::vector<report::LayerRow> layers;   ///< settled
  double compaction_rate = 0.0;           ///< [1/s] of the last settled layer
  GlobalId moving_from = 0;               ///< particles with smaller ids are frozen
  double height = 0.0;                    ///< [m] of the bed, as last measured
  std::int64_t relaxations = 0;           ///< final stages begun and finished so far
  std::int64_t relaxation_steps = 0;      ///< of all of them
  double height_before_relaxation = 0.0;  ///< [m]
  Phase phase = Phase::insertion;
  report::LayerRow row{};        ///< of the layer that settles, as far as known
  std::int64_t done = 0;         ///< steps of the phase so far
  double phi_before = 0.0;       ///< solid fraction that the compaction rate is measured from, once known
  double mean_height = 0.0;      ///< [m] of the moving particles at the last look for rest
  std::int64_t calm_since = -1;  ///< step of the phase since which they are at rest; -1: they are not
  double phi_calm = 0.0;         ///< solid fraction then
};

/// Collective. Writes PATH whole or not at all: temporary, fsync, rename, fsync of the folder. The bits of the records
/// are written as they are; rows by id, whatever the ranks; nothing is gathered. The particles are the owned ones of
/// all `stores`, which have one layout. Throws as write_pack(). Memory: about 200 bytes a particle of this rank's
/// share, for the time of the call.
void write_checkpoint(const comm::Comm& comm, const std::string& path, std::span<const particles::Store* const> stores,
                      const RunState& state);

/// Bytes of the file that write_checkpoint() would write of state.count particles. Rank-local. Throws
/// Error(io_failure).
[[nodiscard]] std::int64_t checkpoint_bytes(const particles::Layout& layout, const RunState& state);

/// The state in the checkpoint PATH, its digest verified; the particles are not looked at. What a former version wrote
/// comes in the names of today. Rank-local.
/// Throws Error(bad_checkpoint): "PATH: what is wrong".
[[nodiscard]] RunState read_state(const std::string& path);

/// Collective. The state in PATH, and into the empty `store` this rank's share of its particles (a run of ids; no rank
/// owns them by place yet). Everything is verified against the digests in the file. Throws Error(bad_checkpoint) on all
/// ranks; then `store` is in no particular state.
[[nodiscard]] RunState read_checkpoint(const comm::Comm& comm, const std::string& path, particles::Store& store);

}  // namespace packmpi::pack
