#include "cli/convert.hpp"

#include <fmt/format.h>

namespace packmpi::cli {

std::string convert(const comm::Comm& comm, const Request& asked) {
  exporters::ConvertRequest request = asked.convert;
  request.force = asked.run.force;
  const exporters::Converted done = exporters::convert_pack(comm, request);
  std::string files;
  for (const std::string& file : done.files) files += (files.empty() ? "" : ", ") + file;
  const std::string of = done.particles < done.of ? fmt::format(" of {}", done.of) : "";
  std::string text =
      fmt::format("{}: {}{} particles, {:.9g} m3, for {}\n", files, done.particles, of, done.volume, request.format);
  if (!done.cut.empty()) {
    text += fmt::format("cut out: {}; solid fraction {:.9f}, porosity {:.9f}, spheres cut by its sides\n", done.cut,
                        done.cut_fraction, 1.0 - done.cut_fraction);
  }
  if (!done.springs.empty()) text += fmt::format("springs of friction: {}\n", done.springs);
  return text;
}

}  // namespace packmpi::cli
