/// What goes into a pack file: the datasets, from rows that are already where they belong. Private to this module.
#pragma once
#include <vector>

#include "comm/comm.hpp"
#include "disk/hdf5.hpp"
#include "disk/scatter.hpp"
#include "pack/pack.hpp"
#include "report/record.hpp"

namespace packmpi::pack {

/// One particle on its way to the file.
struct ParticleRow {
  GlobalId id;
  Vec3 position, velocity, spin;
  double radius;
  std::int32_t layer, contacts;
  std::int32_t component;  // 0 where there is one only
};

/// This rank's block of the file, and the rows of it that are at hand.
struct PackBlock {
  bool rotation = true;
  bool mixture = false;  // several components
  disk::h5::Slab particles{};
  std::vector<ParticleRow> rows;  // by id, without gap
  bool has_contacts = false;
  disk::h5::Slab contacts{};
  disk::h5::Slab walls{};
  std::vector<ContactRow> contact_rows, wall_rows;  // by (first, second)
  scene::Features features{};                       // memory and rolling of the contacts
  const observe::ColumnMaps* maps = nullptr;        // not owned; none: no /columns
  disk::h5::Slab columns{};
};

/// Collective. The block, without rows yet but those of maps. Throws Error(numerical_failure) on every rank if an id is
/// not one of 0 .. N-1.
[[nodiscard]] PackBlock make_block(const comm::Comm& comm, const PackParts& parts);

/// Collective. Brings the rows of a piece of the blocks to the ranks that write them, by id. Throws
/// Error(numerical_failure) on every rank if an id is missing or there twice.
void bring_rows(const comm::Comm& comm, const PackParts& parts, const disk::IdPiece& piece, PackBlock& block);

/// The datasets that all ranks write. `block` must outlive the plan.
[[nodiscard]] std::vector<disk::h5::Column> plan_columns(const PackBlock& block);

/// Everything of the file but the rows of `plan`: groups, attributes, small tables, links. Rank-local (rank 0).
void write_frame(hid_t file, const PackBlock& block, const std::vector<disk::h5::Column>& plan,
                 const report::RunRecord& record);

}  // namespace packmpi::pack
