#include <fmt/format.h>

#include "base/error.hpp"
#include "pack/pack.hpp"

namespace packmpi::pack {
namespace {

[[noreturn]] void refuse_scene(const std::string& words) { throw Error(ExitCode::io_failure, words); }

}  // namespace

void check_in_scene(const PackRows& rows, const scene::Scene& scene) {
  constexpr double highest = 10.0;  // of the height asked for and a layer
  if (rows.dimension != scene.container.dimension) {
    refuse_scene(fmt::format("it is a pack in {}D of a scene in {}D", rows.dimension, scene.container.dimension));
  }
  const double largest = scene.sizes.largest();
  const auto up = static_cast<std::size_t>(scene.container.vertical());
  for (std::size_t k = 0; k < rows.id.size(); ++k) {
    if (rows.radius[k] > largest) {
      refuse_scene(fmt::format("particle {} has the radius {} m, the largest of its scene is {} m", rows.id[k],
                               rows.radius[k], largest));
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double x = rows.position[k][axis];
      const double size = axis > up ? 0.0 : scene.container.size[axis];
      const double high = axis == up ? highest * (size + scene.in.layers.thickness) : size + largest;
      if (x >= -largest && x <= high) continue;
      refuse_scene(fmt::format("particle {} is at {} = {} m, far outside of its scene", rows.id[k], "xyz"[axis], x));
    }
  }
}

}  // namespace packmpi::pack
