#include "confine/stress.hpp"

#include <array>
#include <vector>

#include "dynamics/contact_law.hpp"
#include "geometry/volume.hpp"

namespace packmpi::confine {
namespace {

constexpr std::size_t axes = 3;

// Calls take(entry, i, wall, depth) for each particle that touches a wall.
template <class Take>
void each_touch(const particles::Store& store, const scene::Scene& scene, const neighbor::WallList& walls,
                Take&& take) {
  for (std::size_t w = 0; w < walls.particle.size(); ++w) {
    const LocalIndex i = walls.particle[w];
    const double distance = scene.container.plane(walls.wall[w]).distance(store.position(i));
    if (distance < store.radius(i)) take(static_cast<std::int64_t>(w), i, walls.wall[w], distance);
  }
}

}  // namespace

double thickness(const scene::Scene& scene) { return scene.container.dimension == 3 ? 1.0 : 2.0 * scene.sizes.mean(); }

double area_across(const scene::Scene& scene, std::size_t axis) {
  return volume(scene) / (axis == static_cast<std::size_t>(scene.container.vertical()) ? *scene.container.lid
                                                                                       : scene.container.size[axis]);
}

double volume(const scene::Scene& scene) {
  return scene.container.volume_between(0.0, *scene.container.lid) * thickness(scene);
}

Boundary on_boundary(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                     const dynamics::Law& law, const neighbor::Neighborhood& neighborhood) {
  std::vector<std::vector<double>> forces(2 * axes);
  const auto add = [&](std::int64_t, LocalIndex i, neighbor::Wall wall, double) {
    const geometry::Plane plane = scene.container.plane(wall);
    const auto axis = static_cast<std::size_t>(plane.axis);
    // Friction on a plane has no part in it.
    const double force = dynamics::wall_contact(scene, law, store, i, wall).force[axis];
    forces[2 * axis + (plane.sign > 0.0 ? 1 : 0)].push_back(-plane.sign * force);
  };
  each_touch(store, scene, neighborhood.walls(), add);
  const std::vector<double> sums = comm::exact_sums(comm, forces);
  Boundary result;
  for (std::size_t a = 0; a < static_cast<std::size_t>(scene.container.dimension); ++a) {
    result.low[a] = sums[2 * a] / area_across(scene, a);
    result.high[a] = sums[2 * a + 1] / area_across(scene, a);
  }
  return result;
}

Vec3 on_high_walls(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                   const dynamics::Law& law, const neighbor::Neighborhood& neighborhood) {
  std::vector<std::vector<double>> forces(axes);
  each_touch(store, scene, neighborhood.walls(), [&](std::int64_t, LocalIndex i, neighbor::Wall wall, double) {
    const geometry::Plane plane = scene.container.plane(wall);
    const auto axis = static_cast<std::size_t>(plane.axis);
    if (plane.sign > 0.0) forces[axis].push_back(-dynamics::wall_contact(scene, law, store, i, wall).force[axis]);
  });
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
  std::vector<std::vector<double>> terms(axes + 1);
  const auto ids = store.ids();
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    const LocalIndex i = pairs.first[p], j = pairs.second[p];
    // Of a pair across a border the owner of the smaller id counts it.
    if (j >= store.owned() && ids[static_cast<std::size_t>(i)] > ids[static_cast<std::size_t>(j)]) continue;
    const Vec3 l = geometry::separation(scene.container, store.position(i), store.position(j));
    const double reach = store.radius(i) + store.radius(j);
    if (!(dot(l, l) < reach * reach)) continue;
    const Vec3 f = dynamics::pair_contact(scene, law, store, i, j, of_pairs, static_cast<std::int64_t>(p)).force;
    for (std::size_t a = 0; a < axes; ++a) terms[a].push_back(-l[a] * f[a]);
  }
  each_touch(store, scene, neighborhood.walls(), [&](std::int64_t entry, LocalIndex i, neighbor::Wall wall, double d) {
    const Vec3 n = scene.container.plane(wall).normal();
    const Vec3 f = dynamics::wall_contact(scene, law, store, i, wall, of_walls, entry).force;
    for (std::size_t a = 0; a < axes; ++a) terms[a].push_back(-d * n[a] * f[a]);
    const double height = store.position(i)[vertical] + d * n[vertical];  // of where it touches
    terms[axes].push_back(-height * f[vertical]);
  });
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const double weight = scene.in.particles.density * geometry::volume(3, store.radius(i)) * scene.in.jamming.gravity;
    terms[axes].push_back(weight * store.position(i)[vertical]);
  }
  const std::vector<double> sums = comm::exact_sums(comm, terms);
  Stress result;
  for (std::size_t a = 0; a < axes; ++a) result.contacts[a] = sums[a] / volume(scene);
  result.vertical_at_rest = sums[axes] / volume(scene);
  return result;
}

}  // namespace packmpi::confine
