/// The mesh reader with any bytes at all: they are refused in the right words, or the surface is one. The first byte
/// says by its parity what the file is called, a.stl or a.obj.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "base/error.hpp"
#include "fuzz/demand.hpp"
#include "mesh/surface.hpp"

namespace packmpi::fuzz {
namespace {

/// Of what was taken: it has an interior, its text is read as the same surface, and distances agree with each other.
void check_taken(const mesh::Surface& surface) {
  demand(surface.volume() > 0.0 && std::isfinite(surface.volume()), "a surface without an interior is accepted");
  const std::string text = mesh::obj_text(surface.shell());
  const mesh::Surface again(mesh::read_triangles(text, "again.obj"), "again");
  demand(again.digest() == surface.digest(), "its text is read as another surface");
  const Vec3 &low = surface.low(), &high = surface.high();
  // No scene has a radius smaller than that beside its container; places are known to 1e-16 of it.
  const double least = 1e-9 * std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  for (int k = 0; k < 27; ++k) {
    Vec3 x{};
    for (std::size_t a = 0; a < 3; ++a) {
      const int step = a == 0 ? k % 3 : a == 1 ? k / 3 % 3 : k / 9;
      x[a] = low[a] + (0.17 + 0.33 * step) * (high[a] - low[a]);
    }
    const double distance = surface.nearest(x).distance;
    demand(std::isfinite(distance), "a distance that is no number");
    demand((surface.beyond(x) > 0.0) == (distance < 0.0), "beyond() disagrees");
    for (const double r : {0.5, 0.999, 1.001, 2.0}) {
      const double range = r * std::abs(distance);
      if (range > least) demand(surface.fits(x, range) == (surface.distance(x, range) >= range), "fits() disagrees");
    }
  }
}

void try_mesh(const std::string& bytes) {
  const std::string path = !bytes.empty() && bytes[0] % 2 != 0 ? "a.stl" : "a.obj";
  try {
    const auto triangles = mesh::read_triangles(bytes.empty() ? bytes : bytes.substr(1), path);
    check_taken(mesh::Surface(triangles, path));
  } catch (const Error& error) {
    const std::string words = error.what();
    demand(error.code() == ExitCode::bad_input, "refused with another code than bad_input: " + words);
    demand(words.starts_with(path + ":"), "no file's name: " + words);
    demand(std::ranges::none_of(words, [](unsigned char c) { return c < 0x20 || c == 0x7f; }),
           "not one line: " + words);
  }
}

}  // namespace
}  // namespace packmpi::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  packmpi::fuzz::within_a_second(
      [&] { packmpi::fuzz::try_mesh(std::string(reinterpret_cast<const char*>(data), size)); });
  return 0;
}
