#include "run/convert.hpp"

#include <fmt/format.h>

namespace packmpi::run {

std::string convert(const comm::Comm& comm, const Options& options) {
  output::ConvertRequest request = options.convert;
  request.force = options.force;
  const output::Converted done = output::convert_pack(comm, request);
  std::string files;
  for (const std::string& file : done.files) files += (files.empty() ? "" : ", ") + file;
  return fmt::format("{}: {} particles, {:.9g} m3, for {}\n", files, done.particles, done.volume, request.format);
}

}  // namespace packmpi::run
