#include "cli/convert.hpp"

#include <fmt/format.h>

namespace packmpi::cli {

std::string convert(const comm::Comm& comm, const Request& asked) {
  exporters::ConvertRequest request = asked.convert;
  request.force = asked.run.force;
  const exporters::Converted done = exporters::convert_pack(comm, request);
  std::string files;
  for (const std::string& file : done.files) files += (files.empty() ? "" : ", ") + file;
  return fmt::format("{}: {} particles, {:.9g} m3, for {}\n", files, done.particles, done.volume, request.format);
}

}  // namespace packmpi::cli
