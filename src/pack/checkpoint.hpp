/// A run between two steps, on the disk: everything that steers it, nothing that depends on the ranks (design:
/// doc/file_format.md).
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "comm/comm.hpp"
#include "pack/progress.hpp"
#include "particles/store.hpp"
#include "scene/pair_channels.hpp"
#include "scene/scene.hpp"

namespace packmpi::pack {

inline constexpr std::int64_t checkpoint_version = 4;
inline constexpr std::int64_t oldest_checkpoint_version = 2;  ///< that can be read

/// What a checkpoint says beside its particles: who wrote it, of what, and where the run was.
struct RunState {
  std::int64_t serial = 0;      ///< of the checkpoint; a later one has a larger number
  std::string effective_input;  ///< of the run that wrote it
  std::string version, git;     ///< of the program that wrote it
  int dimension = 3;
  bool rotation = true;
  Progress progress;
};

/// What a contact remembers, as one rank keeps it: see neighbor::ContactHistory.
struct HistoryRow {
  GlobalId holder;                                          ///< the higher id; of a wall: the particle
  GlobalId other;                                           ///< the lower id; of a wall: -1 - its number
  std::array<double, scene::most_stored_doubles> values{};  ///< in the order of scene::storings
};

/// The memory of the contacts of a scene where it is at home: each() tells the rows of this rank one by one, in any
/// order, as often as it is asked. No memory in `features`: none.
struct HistoriesHere {
  scene::Features features{};
  std::function<void(const std::function<void(const HistoryRow&)>& see)> each;

  [[nodiscard]] bool any() const noexcept { return features.memory; }
};

/// The memory of the contacts of a scene, each of them on one rank. No rows and no memory in `features`: none.
struct Histories {
  scene::Features features{};  ///< of the scene: dimension, memory and rolling say what is stored
  std::vector<HistoryRow> rows;

  [[nodiscard]] bool any() const noexcept { return features.memory; }
  /// These rows must live as long.
  [[nodiscard]] HistoriesHere here() const {
    return {.features = features, .each = [this](const auto& see) { std::ranges::for_each(rows, see); }};
  }
};

/// Rows on their way to the ranks that write them come in up to 16 pieces of at least so many particles of a rank.
inline constexpr std::int64_t rows_at_a_time = 16384;
/// How many that is of `particles` on so many ranks; a rank may have fewer. Local.
[[nodiscard]] std::int64_t particles_at_a_time(std::int64_t particles, int ranks);

/// Collective. Writes PATH whole or not at all: temporary, fsync, rename, fsync of the folder. The bits of the records
/// are written as they are; rows by id, whatever the ranks; nothing is gathered. The particles are the owned ones of
/// all `stores`, which have one layout. Throws as write_pack(). Memory, for the time of the call: of a sixteenth of
/// this rank's share, or of `piece` particles if that is more, 350 bytes a particle and 250 a contact that remembers.
void write_checkpoint(const comm::Comm& comm, const std::string& path, std::span<const particles::Store* const> stores,
                      const RunState& state, const HistoriesHere& histories = {}, std::int64_t piece = rows_at_a_time);

/// Bytes of the file that write_checkpoint() would write of state.progress.count particles and so many contacts that
/// remember, if those of `features` do. Rank-local. Throws Error(io_failure).
[[nodiscard]] std::int64_t checkpoint_bytes(const particles::Layout& layout, const RunState& state,
                                            const scene::Features& features = {}, std::int64_t contacts = 0);

/// The state in the checkpoint PATH, its digest verified; the particles are not looked at. What a former version wrote
/// comes in the names of today. Rank-local.
/// Throws Error(bad_checkpoint): "PATH: what is wrong".
[[nodiscard]] RunState read_state(const std::string& path);

/// Collective. The state in PATH, and into the empty `store` this rank's share of its particles (a run of ids; no rank
/// owns them by place yet); into `histories` those that these particles hold. Everything is verified against the
/// digests in the file. Throws Error(bad_checkpoint) on all ranks; then `store` is in no particular state.
[[nodiscard]] RunState read_checkpoint(const comm::Comm& comm, const std::string& path, particles::Store& store,
                                       Histories* histories = nullptr);

/// Throws Error(bad_checkpoint), words without the path, unless this rank's particles and histories can be those of a
/// run of `scene`: radii in its range, histories if and only if its contacts remember, and no spring longer than its
/// friction can hold. Where particles are, the guards of the run look at. Local.
void check_in_scene(const particles::Store& store, const Histories& histories, const scene::Scene& scene);

}  // namespace packmpi::pack
