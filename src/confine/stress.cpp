#include "confine/stress.hpp"

#include <array>
#include <numbers>
#include <vector>

#include "comm/exact_sum.hpp"
#include "dynamics/contact_law.hpp"
#include "observe/touch.hpp"
#include "scene/mixture.hpp"

namespace packmpi::confine {
namespace {

constexpr std::size_t axes = 3;

// Of round side walls that are seen from inside, up to the lid [m2].
double mantle_area(const scene::Scene& scene) {
  const geometry::Container& vessel = scene.container;
  const double inner = vessel.has(geometry::Surface::inner) ? 2.0 * std::numbers::pi * vessel.core * *vessel.lid : 0.0;
  return (vessel.wall_area(*vessel.lid) - inner) * thickness(scene);
}

// [Pa] of a force on an area that may not be there.
double stress_of(double force, double area) { return area > 0.0 ? force / area : 0.0; }

}  // namespace

double thickness(const scene::Scene& scene) { return scene.container.dimension == 3 ? 1.0 : 2.0 * scene.sizes.mean(); }

double area_across(const scene::Scene& scene, std::size_t axis) {
  const geometry::Container& vessel = scene.container;
  const bool vertical = axis == static_cast<std::size_t>(vessel.vertical());
  if (vertical && !vessel.is_box()) return vessel.area_at(*vessel.lid) * thickness(scene);
  return volume(scene) / (vertical ? *vessel.lid : vessel.size[axis]);
}

double volume(const scene::Scene& scene) {
  return scene.container.volume_between(0.0, *scene.container.lid) * thickness(scene);
}

Boundary on_boundary(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                     const dynamics::Law& law, const neighbor::Neighborhood& neighborhood) {
  const geometry::Container& vessel = scene.container;
  std::array<comm::ExactSum, 2 * axes + 1> forces;  // the last: on round walls
  const auto add = [&](std::int64_t, LocalIndex i, neighbor::Wall wall, const geometry::Facing& at) {
    const auto number = static_cast<std::size_t>(wall);
    if (wall == neighbor::Wall::inner || number >= geometry::most_surfaces) return;
    const Vec3 force = dynamics::wall_contact(scene, law, store, i, at).force;  // friction has no normal part
    if (number >= geometry::most_planes) return forces.back().add(-dot(force, at.normal));
    const geometry::Plane plane = vessel.plane(wall);
    const auto axis = static_cast<std::size_t>(plane.axis);
    forces[2 * axis + (plane.sign > 0.0 ? 1 : 0)].add(-plane.sign * force[axis]);
  };
  observe::each_touching_wall(store, vessel, neighborhood.walls(), add);
  const std::vector<double> sums = comm::exact_sums(comm, forces);
  const auto vertical = static_cast<std::size_t>(vessel.vertical());
  const double floor = vessel.is_box() ? area_across(scene, vertical) : vessel.area_at(0.0) * thickness(scene);
  const double mantle = vessel.has(geometry::Surface::mantle) ? mantle_area(scene) : 0.0;
  Boundary result;
  result.low[vertical] = stress_of(sums[2 * vertical], floor);
  result.high[vertical] = sums[2 * vertical + 1] / area_across(scene, vertical);
  for (std::size_t a = 0; a < vertical; ++a) {
    result.low[a] = result.high[a] = stress_of(sums.back(), mantle);
    if (!vessel.is_box()) continue;
    result.low[a] = sums[2 * a] / area_across(scene, a);
    result.high[a] = sums[2 * a + 1] / area_across(scene, a);
  }
  return result;
}

Vec3 on_high_walls(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                   const dynamics::Law& law, const neighbor::Neighborhood& neighborhood) {
  std::array<comm::ExactSum, axes> forces;
  const auto add = [&](std::int64_t, LocalIndex i, neighbor::Wall wall, const geometry::Facing& at) {
    if (static_cast<std::size_t>(wall) >= geometry::most_planes) return;
    const geometry::Plane plane = scene.container.plane(wall);
    const auto axis = static_cast<std::size_t>(plane.axis);
    if (plane.sign > 0.0) forces[axis].add(-dynamics::wall_contact(scene, law, store, i, at).force[axis]);
  };
  observe::each_touching_wall(store, scene.container, neighborhood.walls(), add);
  const std::vector<double> sums = comm::exact_sums(comm, forces);
  Vec3 stress{};
  for (std::size_t a = 0; a < static_cast<std::size_t>(scene.container.dimension); ++a) {
    stress[a] = sums[a] / area_across(scene, a);
  }
  return stress;
}

Stress of_contacts(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                   const dynamics::Law& law, const neighbor::Neighborhood& neighborhood) {
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  const neighbor::PairList& pairs = neighborhood.pairs();
  const dynamics::StoredView of_pairs = dynamics::stored_pairs(neighborhood);
  const dynamics::StoredView of_walls = dynamics::stored_walls(neighborhood);
  std::array<comm::ExactSum, axes + 1> terms;
  const auto ids = store.ids();
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    const LocalIndex i = pairs.first[p], j = pairs.second[p];
    // Of a pair across a border the owner of the smaller id counts it.
    if (j >= store.owned() && ids[static_cast<std::size_t>(i)] > ids[static_cast<std::size_t>(j)]) continue;
    const Vec3 l = geometry::separation(scene.container, store.position(i), store.position(j));
    const double reach = store.radius(i) + store.radius(j);
    if (!(dot(l, l) < reach * reach)) continue;
    const Vec3 f = dynamics::pair_contact(scene, law, store, i, j, of_pairs, static_cast<std::int64_t>(p)).force;
    for (std::size_t a = 0; a < axes; ++a) terms[a].add(-l[a] * f[a]);
  }
  const auto touch = [&](std::int64_t entry, LocalIndex i, neighbor::Wall, const geometry::Facing& at) {
    const Vec3 f = dynamics::wall_contact(scene, law, store, i, at, of_walls, entry).force;
    for (std::size_t a = 0; a < axes; ++a) terms[a].add(-at.distance * at.normal[a] * f[a]);
    const double height = store.position(i)[vertical] + at.distance * at.normal[vertical];  // of where it touches
    terms[axes].add(-height * f[vertical]);
  };
  observe::each_touching_wall(store, scene.container, neighborhood.walls(), touch);
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const double weight = scene::mass_of(scene, store, i) * scene.in.jamming.gravity;
    terms[axes].add(weight * store.position(i)[vertical]);
  }
  const std::vector<double> sums = comm::exact_sums(comm, terms);
  Stress result;
  for (std::size_t a = 0; a < axes; ++a) result.contacts[a] = sums[a] / volume(scene);
  result.vertical_at_rest = sums[axes] / volume(scene);
  return result;
}

}  // namespace packmpi::confine
