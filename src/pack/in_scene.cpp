#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "neighbor/contact_memory.hpp"
#include "pack/checkpoint.hpp"
#include "pack/histories.hpp"
#include "pack/pack.hpp"
#include "scene/mixture.hpp"

namespace packmpi::pack {
namespace {

[[noreturn]] void refuse_scene(const std::string& words) { throw Error(ExitCode::io_failure, words); }

/// Packs of version 1 may have radii in single precision.
constexpr double rounding = 1e-6;

/// What is wrong with the radius of a particle; nothing if it can be of the scene.
std::string fault_of_radius(double radius, const scene::Sizes& sizes) {
  if (radius > sizes.largest()) return fmt::format("the largest of its scene is {} m", sizes.largest());
  if (radius < sizes.smallest() * (1.0 - rounding)) {
    return fmt::format("the smallest of its scene is {} m", sizes.smallest());
  }
  return {};
}

std::string words_of_radius(GlobalId id, double radius, const std::string& fault) {
  return fmt::format("particle {} has the radius {} m, {}", id, radius, fault);
}

[[noreturn]] void refuse_in_scene(const std::string& words) { throw Error(ExitCode::bad_checkpoint, words); }

void check_radii(const particles::Store& store, const scene::Sizes& sizes) {
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const std::string fault = fault_of_radius(store.radius(i), sizes);
    if (fault.empty()) continue;
    refuse_in_scene(words_of_radius(store.ids()[static_cast<std::size_t>(i)], store.radius(i), fault));
  }
}

/// [m] that no spring of the coefficient `friction` is longer than. Sliding, it is mu f_n / k_t, that is of the elastic
/// force mu E* / (6 G*) times the overlap, which the guards keep below half a radius. The dashpot adds to f_n less than
/// twenty times the damping ratio as much, however small the overlap (doc/file_format.md).
double longest_spring(const scene::Scene& scene, double friction) {
  const input::Input& in = scene.in;
  const double nu = in.particles.poisson_ratio;
  const double moduli = 2.0 * (2.0 - nu) / (1.0 - nu);  // E* / G*
  return friction * moduli / 6.0 * (1.0 + 20.0 * in.contact.damping_ratio) * 0.5 * scene.sizes.largest();
}

/// Is the other end of this contact, if it is a wall, one that the scene has? The lid comes with the confinement.
bool has_wall(const scene::Scene& scene, const HistoryRow& row) {
  if (row.other >= 0) return true;
  const auto wall = static_cast<geometry::Surface>(neighbor::wall_partner(neighbor::Wall{}) - row.other);
  return scene.container.has(wall) || (wall == geometry::Surface::lid && scene.in.confinement);
}

void check_walls(const Histories& histories, const scene::Scene& scene) {
  for (const HistoryRow& row : histories.rows) {
    if (has_wall(scene, row)) continue;
    refuse_in_scene(fmt::format("its contact of {} and {} has ends that cannot be: the scene has no such wall",
                                row.other, row.holder));
  }
}

/// Of contacts, the largest coefficients and the least 1/k_t that any two components have.
double longest_of_any(const scene::Scene& scene, double scene::Friction::*which) {
  const auto count = static_cast<int>(scene.in.components.size());
  double longest = 0.0;
  const auto heed = [&](const scene::PairMaterial& of) {
    const double moduli = of.normal_modulus / of.shear_modulus;
    longest = std::max(longest, of.friction.*which * moduli / 6.0 * (1.0 + 20.0 * of.damping_ratio));
  };
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b <= a; ++b) heed(scene::pair_material(scene.in, a, b));
    heed(scene::wall_material(scene.in, a));
  }
  return longest * 0.5 * scene.sizes.largest();
}

}  // namespace

void check_springs(const Histories& histories, const scene::Scene& scene) {
  check_walls(histories, scene);
  const input::Contact& contact = scene.in.contact;
  std::array longest{longest_spring(scene, std::max(contact.friction, contact.wall_friction)),
                     longest_spring(scene, contact.rolling_friction), longest_spring(scene, contact.twisting_friction)};
  if (scene.features.mixture) {
    longest = {longest_of_any(scene, &scene::Friction::particles), longest_of_any(scene, &scene::Friction::rolling),
               longest_of_any(scene, &scene::Friction::twisting)};
  }
  for (const HistoryRow& row : histories.rows) {
    std::size_t at = 0, which = 0;
    for (const scene::Storing& what : scene::storings(histories.features)) {
      double square = 0.0;
      for (int c = 0; c < what.components; ++c, ++at) square += row.values[at] * row.values[at];
      if (square <= longest[which] * longest[which]) {
        ++which;
        continue;
      }
      refuse_in_scene(fmt::format("the {} of particle {} and {} is {} m, and friction holds at most {} m", what.name,
                                  row.holder, row.other, std::sqrt(square), longest[which]));
    }
  }
}

namespace {

void check_components(const PackRows& rows, const scene::Scene& scene) {
  if (rows.component.empty() == scene.features.mixture && !rows.id.empty())
    refuse_scene("its particles have components and its scene none, or the other way round");
  const auto count = static_cast<std::int32_t>(scene.in.components.size());
  for (std::size_t k = 0; k < rows.component.size(); ++k) {
    if (rows.component[k] >= 0 && rows.component[k] < count) continue;
    refuse_scene(fmt::format("particle {} is of component {}, of {}", rows.id[k], rows.component[k], count));
  }
}

}  // namespace

void check_in_scene(const particles::Store& store, const Histories& histories, const scene::Scene& scene) {
  check_radii(store, scene.sizes);
  const scene::Features &of = histories.features, &wanted = scene.features;
  if (of.memory != wanted.memory || (of.memory && of.rolling != wanted.rolling)) {
    refuse_in_scene(
        "what its contacts remember is not what those of the scene do: go on with the packmpi that wrote "
        "it, or begin anew");
  }
  check_springs(histories, scene);
}

void check_in_scene(const PackRows& rows, const scene::Scene& scene) {
  constexpr double highest = 1e3;  // of the height asked for and a layer: count may ask for more, speeds throw higher
  if (rows.dimension != scene.container.dimension) {
    refuse_scene(fmt::format("it is a pack in {}D of a scene in {}D", rows.dimension, scene.container.dimension));
  }
  check_components(rows, scene);
  const double largest = scene.sizes.largest();
  const auto up = static_cast<std::size_t>(scene.container.vertical());
  for (std::size_t k = 0; k < rows.id.size(); ++k) {
    const std::string fault = fault_of_radius(rows.radius[k], scene.sizes);
    if (!fault.empty()) refuse_scene(words_of_radius(rows.id[k], rows.radius[k], fault));
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
