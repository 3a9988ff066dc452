#include "observe/contact_force.hpp"

#include <algorithm>
#include <cmath>

namespace packmpi::observe {
namespace {

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// What two bodies do where they touch, seen from the first.
struct Meeting {
  Vec3 normal;     // unit, from the first to the second
  double overlap;  // [m]
  Vec3 velocity;   // of the second's centre past the first's [m/s]
  Vec3 roll;       // radius times spin, summed over both [m/s]
  Reduced reduced;
};

/// Force [N] on the first.
Vec3 force(const dynamics::Law& law, const dynamics::LawConstants& kind, const Meeting& at) {
  const double approach = -dot(at.velocity, at.normal);
  const double normal = normal_force(law, kind, at.reduced, at.overlap, approach);
  const Vec3 surface = cross(at.roll, at.normal);
  Vec3 slip{};  // of the second past the first at the contact point
  for (std::size_t c = 0; c < 3; ++c) {
    slip[c] = at.velocity[c] + approach * at.normal[c] - law.spin_slip * surface[c];
  }
  const double speed = std::sqrt(dot(slip, slip));
  const double stopping = law.slip_mass * at.reduced.mass * law.slip_rate;  // [N s/m]
  const double drag = speed > 0.0 ? std::min(kind.friction * std::abs(normal) / speed, stopping) : 0.0;
  Vec3 on_first{};
  for (std::size_t c = 0; c < 3; ++c) on_first[c] = drag * slip[c] - normal * at.normal[c];
  return on_first;
}

}  // namespace

double normal_force(const dynamics::Law& law, const dynamics::LawConstants& kind, const Reduced& reduced,
                    double overlap, double rate) {
  const double root = std::sqrt(reduced.radius * overlap);
  const double elastic = kind.stiffness * root * overlap;
  const double viscous = kind.damping * std::sqrt(reduced.mass * root) * rate;
  return std::max(elastic + viscous, law.lowest_force);
}

Vec3 pair_force(const particles::Store& store, const dynamics::Law& law, LocalIndex i, LocalIndex j, const Touch& at) {
  const double ri = store.radius(i);
  const double rj = store.radius(j);
  const double ki = 1.0 / ri;
  const double kj = 1.0 / rj;
  const Vec3 vi = store.velocity(i);
  const Vec3 vj = store.velocity(j);
  const Vec3 wi = store.spin(i);
  const Vec3 wj = store.spin(j);
  return force(law, law.pair,
               {.normal = at.normal,
                .overlap = at.overlap,
                .velocity = {vj[0] - vi[0], vj[1] - vi[1], vj[2] - vi[2]},
                .roll = {ri * wi[0] + rj * wj[0], ri * wi[1] + rj * wj[1], ri * wi[2] + rj * wj[2]},
                .reduced = {1.0 / (ki + kj), 1.0 / (law.mass_factor * (ki * ki * ki + kj * kj * kj))}});
}

Vec3 wall_force(const particles::Store& store, const geometry::Container& box, const dynamics::Law& law, LocalIndex i,
                neighbor::Wall wall, double penetration) {
  const double r = store.radius(i);
  const Vec3 v = store.velocity(i);
  const Vec3 w = store.spin(i);
  return force(law, law.wall,
               {.normal = box.plane(wall).normal(),
                .overlap = penetration,
                .velocity = {-v[0], -v[1], -v[2]},
                .roll = {r * w[0], r * w[1], r * w[2]},
                .reduced = {r, r * r * r / law.mass_factor}});
}

}  // namespace packmpi::observe
