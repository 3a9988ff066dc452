/// Contact forces one by one.
#include <algorithm>
#include <tuple>

#include "comm/exact_sum.hpp"
#include "dynamics/contact_law.hpp"
#include "observe/measure.hpp"
#include "observe/touch.hpp"

namespace packmpi::observe {
namespace {

Vec3 middle(const geometry::Container& box, const Vec3& from, const Vec3& branch) {
  Vec3 x{};
  for (std::size_t a = 0; a < 3; ++a) {
    x[a] = from[a] + 0.5 * branch[a];
    if (a < static_cast<std::size_t>(box.lateral_axes()) && box.periodic[a]) x[a] = geometry::wrap(x[a], box.size[a]);
  }
  return x;
}

/// As the first end has it, or the other; a zero without its sign, which depends on the end.
Vec3 seen(const Vec3& a, double sign) { return {sign * a[0] + 0.0, sign * a[1] + 0.0, sign * a[2] + 0.0}; }

/// From the end with the smaller id.
void turn(dynamics::ContactEffect& effect, bool turned) {
  const double sign = turned ? -1.0 : 1.0;
  effect.force = seen(effect.force, sign);
  effect.springs.tangential = seen(effect.springs.tangential, sign);
  effect.springs.rolling = seen(effect.springs.rolling, sign);
  effect.springs.twisting = effect.springs.twisting + 0.0;
}

void sort_by_ends(std::vector<ContactForce>& rows) {
  std::sort(rows.begin(), rows.end(), [](const ContactForce& a, const ContactForce& b) {
    return std::tie(a.first, a.second) < std::tie(b.first, b.second);
  });
}

}  // namespace

void each_contact(const particles::Store& store, const scene::Scene& scene, const neighbor::PairList& pairs,
                  const dynamics::StoredView& stored, const std::function<void(const ContactForce&)>& take) {
  const dynamics::Law law = dynamics::make_law(scene);
  const auto ids = store.ids();
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    LocalIndex i = pairs.first[p];
    LocalIndex j = pairs.second[p];
    const bool turned = ids[static_cast<std::size_t>(i)] > ids[static_cast<std::size_t>(j)];
    if (turned) std::swap(i, j);
    if (i >= store.owned()) continue;  // the other rank reports it
    const Touch at = touch(store, scene.container, i, j);
    if (!(at.overlap > 0.0)) continue;
    const auto entry = static_cast<std::int64_t>(p);
    dynamics::ContactEffect effect =
        dynamics::pair_contact(scene, law, store, pairs.first[p], pairs.second[p], stored, entry);
    turn(effect, turned);
    const Vec3 xi = store.position(i);
    const Vec3 branch = geometry::separation(scene.container, xi, store.position(j));
    take({.first = ids[static_cast<std::size_t>(i)],
          .second = ids[static_cast<std::size_t>(j)],
          .overlap = at.overlap,
          .force = effect.force,
          .branch = branch,
          .middle = middle(scene.container, xi, branch),
          .normal = at.normal,
          .springs = effect.springs});
  }
}

std::vector<ContactForce> contact_forces(const particles::Store& store, const scene::Scene& scene,
                                         const neighbor::PairList& pairs, const dynamics::StoredView& stored) {
  std::size_t most = 0;  // or room for twice as many, of 200 bytes each
  each_touching(store, scene.container, pairs, [&](std::int64_t, LocalIndex, LocalIndex, double) { ++most; });
  std::vector<ContactForce> rows;
  rows.reserve(most);
  each_contact(store, scene, pairs, stored, [&](const ContactForce& contact) { rows.push_back(contact); });
  sort_by_ends(rows);
  return rows;
}

std::vector<ContactForce> wall_forces(const particles::Store& store, const scene::Scene& scene,
                                      const neighbor::WallList& walls, const dynamics::StoredView& stored) {
  const dynamics::Law law = dynamics::make_law(scene);
  std::vector<ContactForce> rows;
  each_touching_wall(store, scene.container, walls,
                     [&](std::int64_t entry, LocalIndex i, neighbor::Wall wall, const geometry::Facing& at) {
                       const dynamics::ContactEffect effect =
                           dynamics::wall_contact(scene, law, store, i, at, stored, entry);
                       rows.push_back({.first = store.ids()[static_cast<std::size_t>(i)],
                                       .second = neighbor::wall_partner(wall),
                                       .overlap = store.radius(i) - at.distance,
                                       .force = effect.force,
                                       .normal = at.normal,
                                       .springs = effect.springs});
                     });
  sort_by_ends(rows);
  return rows;
}

double floor_force(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                   const neighbor::WallList& walls) {
  const dynamics::Law law = dynamics::make_law(scene);
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  comm::ExactSum forces;
  each_touching_wall(store, scene.container, walls,
                     [&](std::int64_t, LocalIndex i, neighbor::Wall wall, const geometry::Facing& at) {
                       if (wall != neighbor::Wall::floor) return;
                       const double up = dynamics::wall_contact(scene, law, store, i, at).force[vertical];
                       forces.add(up);  // friction on a plane has no part in it
                     });
  return comm::exact_sum(comm, forces);
}

}  // namespace packmpi::observe
