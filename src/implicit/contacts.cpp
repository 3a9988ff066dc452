#include "implicit/contacts.hpp"

#include "geometry/container.hpp"

namespace packmpi::dynamics {
namespace {

// r omega [m/s]; in 2D about z.
Vec3 surface_spin(const particles::Store& store, LocalIndex i) {
  const particles::Layout& layout = store.layout();
  Vec3 s{};
  const int first = layout.dimension == 3 ? 0 : 2;
  for (int c = 0; c < layout.spin_components(); ++c) {
    s[static_cast<std::size_t>(first) + static_cast<std::size_t>(c)] = store.record(i)[layout.spin + c];
  }
  return s;
}

}  // namespace

double inverse_mass(const Law& law, const particles::Store& store, LocalIndex i) {
  const double k = store.record(i)[store.layout().curvature];
  return law.mass_factor * k * k * k;
}

Interaction of_pair(const scene::Scene& scene, const Law& law, const particles::Store& store, LocalIndex i,
                    LocalIndex j) {
  const double ri = store.radius(i), rj = store.radius(j);
  const double inverse_masses = inverse_mass(law, store, i) + inverse_mass(law, store, j);
  Interaction at{.first = i,
                 .second = j,
                 .d = geometry::separation(scene.container, store.position(i), store.position(j)),
                 .v = {},
                 .s = {},
                 .wall_normal = {},
                 .radii = ri + rj,
                 .reduced_radius = ri * rj / (ri + rj),
                 .reduced_mass = 1.0 / inverse_masses};
  const Vec3 vi = store.velocity(i), vj = store.velocity(j), si = surface_spin(store, i), sj = surface_spin(store, j);
  for (std::size_t a = 0; a < 3; ++a) {
    at.v[a] = vj[a] - vi[a];
    at.s[a] = si[a] + sj[a];
  }
  return at;
}

Interaction of_wall(const Law& law, const particles::Store& store, LocalIndex i, const geometry::Facing& at_wall) {
  const Vec3 v = store.velocity(i);
  Interaction at{.first = i,
                 .second = -1,
                 .d = {},
                 .v = {-v[0], -v[1], -v[2]},
                 .s = surface_spin(store, i),
                 .wall_normal = at_wall.normal,
                 .radii = store.radius(i),
                 .reduced_radius = store.radius(i),
                 .reduced_mass = 1.0 / inverse_mass(law, store, i)};
  for (std::size_t a = 0; a < 3; ++a) at.d[a] = at_wall.normal[a] * at_wall.distance + 0.0;  // no -0
  return at;
}

}  // namespace packmpi::dynamics
