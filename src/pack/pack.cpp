#include "pack/pack.hpp"

#include <vector>

#include "base/memory.hpp"
#include "disk/whole_file.hpp"
#include "pack/pack_plan.hpp"

namespace packmpi::pack {

void write_pack(const comm::Comm& comm, const std::string& path, const PackParts& parts,
                const report::RunRecord& record, std::int64_t piece) {
  const Occupation now("the pack on its way to the file");
  const disk::h5::Quiet quiet;
  PackBlock block = make_block(comm, parts);
  const std::vector<disk::h5::Column> plan = plan_columns(block);
  const disk::IdPieces pieces{{static_cast<std::int64_t>(block.particles.total), comm.size()}, piece};
  const disk::Pieces supply{.count = pieces.count(),
                            .bring = [&](std::int64_t k) { bring_rows(comm, parts, pieces.piece(k), block); }};
  disk::write_whole_file(
      comm, path, plan, [&](hid_t file) { write_frame(file, block, plan, record); }, supply);
}

std::int64_t pack_bytes(const report::RunRecord& record, bool rotation, std::int64_t particles,
                        std::optional<ContactCounts> contacts, std::int64_t columns) {
  PackBlock block;
  block.rotation = rotation;
  block.particles = {static_cast<hsize_t>(particles), 0, 0};
  block.has_contacts = contacts.has_value();
  const ContactCounts counts = contacts.value_or(ContactCounts{});
  block.contacts = {static_cast<hsize_t>(counts.pairs), 0, 0};
  block.walls = {static_cast<hsize_t>(counts.walls), 0, 0};
  block.features = counts.features;
  const observe::ColumnMaps maps;
  if (columns > 0) block.maps = &maps;
  block.columns = {static_cast<hsize_t>(columns), 0, 0};
  const std::vector<disk::h5::Column> plan = plan_columns(block);
  return disk::whole_file_bytes(plan, [&](hid_t file) { write_frame(file, block, plan, record); });
}

}  // namespace packmpi::pack
