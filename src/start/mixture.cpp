#include "start/mixture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "comm/exact_sum.hpp"
#include "geometry/volume.hpp"
#include "scene/mixture.hpp"
#include "start/fit.hpp"

namespace packmpi::start {
namespace {

std::string names_of(const input::Input& in) {
  if (in.components.empty()) return "one material";
  std::string all;
  for (const input::Component& of : in.components)
    all += fmt::format("{}{}", all.empty() ? "the components " : ", ", of.name);
  return all;
}

}  // namespace

void check_one_material(const scene::Scene& scene) {
  if (!scene.features.mixture) return;
  refuse(scene,
         "start.pack: particles of a text file are of one material, and the scene has several components; go on "
         "from a pack (.hdf)");
}

void check_components(const scene::Scene& scene, const input::Input& made) {
  const std::string before = names_of(made), now = names_of(scene.in);
  if (before != now)
    refuse(scene, fmt::format("start.pack: is of {}, the scene of {}; give those of the pack", before, now));
}

control::Mixing mixing_of(const comm::Comm& comm, const scene::Scene& scene, const pack::PackRows& rows,
                          const std::vector<GlobalId>& first_ids) {
  control::Mixing mixing = control::begin_mixing(scene);
  const std::size_t components = scene.in.components.size();
  mixing.counts.assign(first_ids.size() * components, 0);
  mixing.strata.assign(first_ids.size(), 0);
  const auto layer_of = [&](GlobalId id) {
    return static_cast<std::size_t>(std::ranges::upper_bound(first_ids, id) - first_ids.begin()) - 1;
  };
  comm::ExactSum extents;
  for (std::size_t k = 0; k < rows.id.size(); ++k) {
    const auto component = static_cast<std::size_t>(rows.component[k]);
    ++mixing.counts[layer_of(rows.id[k]) * components + component];
    ++mixing.drawn[component];
    mixing.units[component] += scene::units_of(scene, rows.radius[k]);
    extents.add(geometry::volume(scene.container.dimension, rows.radius[k]));
  }
  comm.sum(std::span(mixing.counts));
  comm.sum(std::span(mixing.drawn));
  comm.sum(std::span(mixing.units));
  mixing.wanted = mixing.units;
  mixing.extent = comm::exact_sum(comm, extents);
  bool ascend = true;
  for (std::size_t k = 0; k < rows.id.size(); ++k) {
    const std::size_t layer = layer_of(rows.id[k]);
    ascend &= control::component_of(mixing, layer, first_ids[layer], rows.id[k]) == rows.component[k];
  }
  if (comm.max(std::int64_t{ascend ? 0 : 1}) > 0)
    refuse(scene, "start.pack: its ids do not ascend with layers and components; go on from one that packmpi has made");
  return mixing;
}

}  // namespace packmpi::start
