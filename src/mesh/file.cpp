#include "mesh/file.hpp"

#include <fmt/format.h>

#include <vector>

#include "base/error.hpp"
#include "base/regular_file.hpp"
#include "base/text.hpp"
#include "mesh/bodies.hpp"
#include "mesh/vectors.hpp"

namespace packmpi::mesh {

std::string read_file(const comm::Comm& comm, const std::string& path) {
  std::string bytes;
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0) return;
    const RegularFile file(path);
    if (!file.flaw().empty()) throw Error(ExitCode::bad_input, fmt::format("{} {}", path, file.flaw()));
    if (file.size() > most_bytes) {
      throw Error(ExitCode::bad_input,
                  fmt::format("{}: it has {}, and {} are the limit; simplify the surface", path,
                              text::bytes(static_cast<std::uint64_t>(file.size())), text::bytes(most_bytes)));
    }
    std::optional<std::string> found = file.read(0, file.size());
    if (!found) throw Error(ExitCode::bad_input, path + ": it cannot be read");
    bytes = std::move(*found);
  });
  return comm.broadcast(0, bytes);
}

std::shared_ptr<const Surface> make_surface(const std::string& bytes, const std::string& path, double unit) {
  const auto scaled = [&](const Vec3& x) { return times(unit, x); };
  return std::make_shared<const Surface>(moved(read_triangles(bytes, path), scaled), path);
}

std::string mended_words(const Mended& mended) {
  std::string words;
  if (mended.dropped > 0) words += fmt::format(", {} triangles without an area left out", mended.dropped);
  if (mended.turned > 0) words += fmt::format(", {} turned outside", mended.turned);
  return words;
}

}  // namespace packmpi::mesh
