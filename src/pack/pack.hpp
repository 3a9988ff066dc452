/// The pack file: what is in it, writing and reading (design: doc/file_format.md).
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "comm/comm.hpp"
#include "observe/column_maps.hpp"
#include "observe/measure.hpp"
#include "pack/checkpoint.hpp"
#include "particles/store.hpp"
#include "report/record.hpp"
#include "scene/scene.hpp"

namespace packmpi::pack {

inline constexpr std::int64_t pack_version = 2;
inline constexpr std::int64_t oldest_pack_version = 1;  ///< that can be read

/// One contact for /contacts or /wall_contacts.
using ContactRow = observe::ContactForce;

/// How many contacts a pack has, and what they remember.
struct ContactCounts {
  std::int64_t pairs = 0, walls = 0;
  scene::Features features{};  ///< memory and rolling of them
};

/// What this rank contributes to a pack.
struct PackParts {
  const particles::Store* store = nullptr;  ///< owned particles; ids over all ranks are 0 .. N-1 without gap
  std::span<const std::int32_t> layer;      ///< of the owned, in slot order
  std::span<const std::int32_t> contacts;   ///< touching particles of the owned, in slot order
  const std::vector<ContactRow>* contact_rows = nullptr;  ///< none: no /contacts; on all ranks or on none
  const observe::ColumnMaps* maps = nullptr;              ///< none: no /columns; on all ranks or on none
  const std::vector<ContactRow>* wall_rows = nullptr;     ///< with contact_rows, of walls
  scene::Features features{};                             ///< memory and rolling: what contacts remember
};

/// Collective. Writes PATH (NAME.hdf): to PATH.tmp, flushed, fsync'ed, renamed. Rows sorted by id whatever the ranks;
/// nothing is gathered. Throws on every rank: Error(io_failure) with the reason (full disk, permissions), or
/// Error(numerical_failure) if the ids are not 0 .. N-1; then PATH is untouched and PATH.tmp is gone.
/// Memory, for the time of the call: of a sixteenth of this rank's share, or of `piece` particles if that is more, 350
/// bytes a particle and 500 a contact.
void write_pack(const comm::Comm& comm, const std::string& path, const PackParts& parts,
                const report::RunRecord& record, std::int64_t piece = rows_at_a_time);

/// Bytes of the file that write_pack() would write of so many particles, contacts (none: no /contacts) and columns of
/// the maps (0: no /columns). Rank-local. Throws Error(io_failure).
[[nodiscard]] std::int64_t pack_bytes(const report::RunRecord& record, bool rotation, std::int64_t particles,
                                      std::optional<ContactCounts> contacts, std::int64_t columns);

/// Rows of a pack, sorted by id.
struct PackRows {
  int dimension = 3;
  std::vector<GlobalId> id;
  std::vector<Vec3> position, velocity, spin;  ///< spin empty if absent
  std::vector<double> radius;
  std::vector<std::int32_t> layer, contacts;
  std::vector<std::int32_t> component;  ///< number among the scene's, from 0; empty if there is one only
};
/// Rank-local (serial) read of a whole pack, for tests and small tools. Throws Error(io_failure), also if any of it is
/// not what was written.
[[nodiscard]] PackRows read_pack(const std::string& path);

/// Collective. Throws Error(io_failure) unless every byte of the pack is as it was written. Returns its seal_of().
/// Cost: one reading of it all, shared by the ranks.
std::uint64_t check_pack(const comm::Comm& comm, const std::string& path);

/// A number that no other pack has: a digest of its seal, which has digests of all its bytes. Its rows are not looked
/// at. Rank-local. Throws Error(io_failure).
[[nodiscard]] std::uint64_t seal_of(const std::string& path);

/// What a pack says of its making.
struct PackOrigin {
  std::string scene;         ///< the effective input, TOML, in the keys of today
  std::string version, git;  ///< of the program that wrote it
  double phi_bulk = 0.0;     ///< solid fraction of the bulk
};
/// Rank-local; rows are not looked at. Throws Error(io_failure).
[[nodiscard]] PackOrigin read_origin(const std::string& path);

/// One rank's share of a pack, and the scene it was made from.
struct PackSlice {
  PackRows rows;                 ///< [rank N / ranks, (rank + 1) N / ranks)
  std::string scene;             ///< the effective input, TOML, in the keys of today
  confine::State confined = {};  ///< lid and sides; off if there are none
};
/// Rank-local: every rank reads its own share, after check_pack(). Throws Error(io_failure).
[[nodiscard]] PackSlice read_slice(const std::string& path, Rank rank, int ranks);

/// Collective, after check_pack(). What the contacts of the pack remember, each on the rank whose read_slice() has its
/// holder; no memory in `features` if the pack has none of it: written with output.contacts = false, or of sliding
/// friction. In 3D to the bit; in the plane to the last digit, since the pack has a vector where a number is stored.
/// Throws Error(io_failure), also if a spring is longer than the friction of `scene` can hold.
[[nodiscard]] Histories histories_of(const comm::Comm& comm, const std::string& path, const scene::Scene& scene);

/// Throws Error(io_failure), words without the path, unless all particles of `rows` fit into `scene`: of its
/// dimension, no larger than its largest, within its floor and walls but for a radius, and not above 10 times the
/// height that it is made for. What lies beyond no grid is made for. Local.
void check_in_scene(const PackRows& rows, const scene::Scene& scene);

/// Rank-local. Whether PATH is a pack, valid or not, rather than another file.
[[nodiscard]] bool is_pack(const std::string& path);

}  // namespace packmpi::pack
