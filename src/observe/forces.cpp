/// Contact forces one by one, with the formulas of the kernel written plainly (CC16 eqs. 7-15).
#include <algorithm>
#include <cmath>
#include <tuple>

#include "dynamics/law.hpp"
#include "observe/measure.hpp"
#include "observe/touch.hpp"

namespace packmpi::observe {
namespace {

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Reduced radius and mass of a contact.
struct Reduced {
  double radius;  // [m]
  double mass;    // [kg]
};

/// Repulsive normal force [N] at an overlap [m] that grows at `rate` [m/s].
double normal_force(const dynamics::Law& law, const dynamics::LawConstants& kind, const Reduced& reduced,
                    double overlap, double rate) {
  const double root = std::sqrt(reduced.radius * overlap);
  const double elastic = kind.stiffness * root * overlap;
  const double viscous = kind.damping * std::sqrt(reduced.mass * root) * rate;
  return std::max(elastic + viscous, law.lowest_force);
}

/// Force [N] on i from its contact with j.
Vec3 pair_force(const particles::Store& store, const dynamics::Law& law, LocalIndex i, LocalIndex j, const Touch& at) {
  const double ri = store.radius(i);
  const double rj = store.radius(j);
  const double ki = 1.0 / ri;
  const double kj = 1.0 / rj;
  const Reduced reduced{1.0 / (ki + kj), 1.0 / (law.mass_factor * (ki * ki * ki + kj * kj * kj))};

  const Vec3 vi = store.velocity(i);
  const Vec3 vj = store.velocity(j);
  const Vec3 u{vj[0] - vi[0], vj[1] - vi[1], vj[2] - vi[2]};
  const double approach = -dot(u, at.normal);
  const double force = normal_force(law, law.pair, reduced, at.overlap, approach);

  const Vec3 wi = store.spin(i);
  const Vec3 wj = store.spin(j);
  const Vec3 roll{ri * wi[0] + rj * wj[0], ri * wi[1] + rj * wj[1], ri * wi[2] + rj * wj[2]};
  const Vec3 surface = cross(roll, at.normal);
  Vec3 slip{};  // of j past i at the contact point
  for (std::size_t c = 0; c < 3; ++c) slip[c] = u[c] + approach * at.normal[c] - law.spin_slip * surface[c];
  const double speed = std::sqrt(dot(slip, slip));
  const double stopping = law.slip_mass * reduced.mass * law.slip_rate;  // [N s/m]
  const double drag = speed > 0.0 ? std::min(law.pair.friction * std::abs(force) / speed, stopping) : 0.0;

  Vec3 on_i{};
  for (std::size_t c = 0; c < 3; ++c) on_i[c] = drag * slip[c] - force * at.normal[c];
  return on_i;
}

}  // namespace

std::vector<ContactForce> contact_forces(const particles::Store& store, const scene::Scene& scene,
                                         const neighbor::PairList& pairs) {
  const dynamics::Law law = dynamics::make_law(scene);
  const auto ids = store.ids();
  std::vector<ContactForce> rows;
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    LocalIndex i = pairs.first[p];
    LocalIndex j = pairs.second[p];
    if (ids[static_cast<std::size_t>(i)] > ids[static_cast<std::size_t>(j)]) std::swap(i, j);
    if (i >= store.owned()) continue;  // the other rank reports it
    const Touch at = touch(store, scene.box, i, j);
    if (!(at.overlap > 0.0)) continue;
    const Vec3 xi = store.position(i);
    const Vec3 branch = geometry::separation(scene.box, xi, store.position(j));
    const auto vertical = static_cast<std::size_t>(scene.box.vertical());
    rows.push_back({ids[static_cast<std::size_t>(i)], ids[static_cast<std::size_t>(j)], at.overlap,
                    pair_force(store, law, i, j, at), branch, xi[vertical] + 0.5 * branch[vertical]});
  }
  std::sort(rows.begin(), rows.end(), [](const ContactForce& a, const ContactForce& b) {
    return std::tie(a.first, a.second) < std::tie(b.first, b.second);
  });
  return rows;
}

double floor_force(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                   const neighbor::WallList& walls) {
  const dynamics::Law law = dynamics::make_law(scene);
  const auto vertical = static_cast<std::size_t>(scene.box.vertical());
  std::vector<double> forces;
  for (std::size_t w = 0; w < walls.particle.size(); ++w) {
    if (walls.wall[w] != neighbor::Wall::floor) continue;
    const LocalIndex i = walls.particle[w];
    const double overlap = wall_penetration(store, scene.box, i, neighbor::Wall::floor);
    if (!(overlap > 0.0)) continue;
    const double r = store.radius(i);
    const Reduced reduced{r, r * r * r / law.mass_factor};
    forces.push_back(normal_force(law, law.wall, reduced, overlap, -store.velocity(i)[vertical]));
  }
  return comm::exact_sum(comm, forces);
}

}  // namespace packmpi::observe
