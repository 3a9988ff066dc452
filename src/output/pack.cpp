#include "output/pack.hpp"

#include <vector>

#include "output/pack_plan.hpp"
#include "output/whole_file.hpp"

namespace packmpi::output {

void write_pack(const comm::Comm& comm, const std::string& path, const PackParts& parts, const RunRecord& record) {
  const h5::Quiet quiet;
  const PackBlock block = make_block(comm, parts);
  const std::vector<h5::Column> plan = plan_columns(block);
  write_whole_file(comm, path, plan, [&](hid_t file) { write_frame(file, block, plan, record); });
}

std::int64_t pack_bytes(const RunRecord& record, bool rotation, std::int64_t particles,
                        std::optional<std::int64_t> contacts) {
  PackBlock block;
  block.rotation = rotation;
  block.particles = {static_cast<hsize_t>(particles), 0, 0};
  block.has_contacts = contacts.has_value();
  block.contacts = {static_cast<hsize_t>(contacts.value_or(0)), 0, 0};
  const std::vector<h5::Column> plan = plan_columns(block);
  return whole_file_bytes(plan, [&](hid_t file) { write_frame(file, block, plan, record); });
}

}  // namespace packmpi::output
