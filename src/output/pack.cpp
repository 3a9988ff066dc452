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

}  // namespace packmpi::output
