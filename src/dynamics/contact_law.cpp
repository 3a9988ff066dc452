// The law's header is the kernels', in a namespace of this file.
#define PACKMPI_KERNEL plain
#include "dynamics/contact_law.hpp"

#include "dynamics/kernel_contact.hpp"
#include "geometry/container.hpp"
#include "scene/mixture.hpp"

namespace packmpi::dynamics {
namespace {

using plain::Meeting;
using plain::Vector;
using scene::Features;

Vec3 array_of(const Vector& a) { return {a.x, a.y, a.z}; }
Vector vector_of(const Vec3& a) { return {a[0], a[1], a[2]}; }

/// In the plane they are numbers: along the tangent (-n_y, n_x), and about z.
SpringDisplacements displacements(int dimension, const Vector& n, const plain::Springs& x) {
  if (dimension == 3) return {array_of(x.slip), array_of(x.roll), x.twist};
  return {{-(n.y * x.slip.x), n.x * x.slip.x, 0.0}, {0.0, 0.0, x.roll.x}, 0.0};
}

template <Features F>
plain::Springs springs(const StoredView& stored, std::int64_t entry) {
  double values[scene::most_stored_doubles] = {};
  for (int k = 0; stored.values != nullptr && k < scene::stored_doubles(F); ++k) {
    values[k] = stored.values[k * stored.entries + entry];
  }
  return plain::springs_of<F>(values);
}

/// Of springs that lie in the plane of now.
double energy_of(double shear_stiffness, double reduced_radius, double overlap, const plain::Springs& x) {
  const double stiffness = shear_stiffness * plain::root(reduced_radius * overlap);
  return 0.5 * stiffness * (dot(x.slip, x.slip) + dot(x.roll, x.roll) + x.twist * x.twist);
}

template <Features F>
ContactEffect resolve(const plain::Constants& c, Meeting at, const StoredView& stored, std::int64_t entry) {
  at.springs = springs<F>(stored, entry);
  const plain::Force f = F.dimension == 3 ? plain::contact_3d<F>(c, at) : plain::contact_2d<F>(c, at);
  ContactEffect effect{array_of(f.force), array_of(f.torque), f.strength, 0.0, {}};
  if (F.memory) {  // in a step of no duration nothing but the springs' planes has changed
    effect.spring_energy = energy_of(c.shear_stiffness, at.reduced.radius, at.overlap, f.springs);
    effect.springs = displacements(F.dimension, at.n, f.springs);
  }
  return effect;
}

/// What the law does to springs in a step of no duration.
template <Features F>
double energy(double shear_stiffness, double reduced_radius, const plain::Touch& at, const StoredView& stored,
              std::int64_t entry) {
  const double overlap = at.gap < 0.0 ? 0.0 : at.gap;
  const plain::SpringState now = {0.0, 0.0, 0.0, overlap, overlap};
  plain::Springs x = springs<F>(stored, entry);
  if constexpr (F.dimension == 3) {
    x.slip = turned(now, at.normal, x.slip);
    x.roll = turned(now, at.normal, x.roll);
  } else {
    x.slip.x = kept_part(now) * x.slip.x;
    x.roll.x = kept_part(now) * x.roll.x;
  }
  x.twist = kept_part(now) * x.twist;
  return energy_of(shear_stiffness, reduced_radius, overlap, x);
}

template <int Dimension>
double energy(const Features& f, const LawConstants& kind, double reduced_radius, const plain::Touch& at,
              const StoredView& stored, std::int64_t entry) {
  constexpr Features memory{.dimension = Dimension, .memory = true};
  constexpr Features rolling{.dimension = Dimension, .memory = true, .rolling = true};
  return f.rolling ? energy<rolling>(kind.shear_stiffness, reduced_radius, at, stored, entry)
                   : energy<memory>(kind.shear_stiffness, reduced_radius, at, stored, entry);
}

double energy(const scene::Scene& scene, const LawConstants& kind, double reduced_radius, const plain::Touch& at,
              const StoredView& stored, std::int64_t entry) {
  if (!scene.features.memory) return 0.0;
  return scene.container.dimension == 3 ? energy<3>(scene.features, kind, reduced_radius, at, stored, entry)
                                        : energy<2>(scene.features, kind, reduced_radius, at, stored, entry);
}

template <int Dimension>
ContactEffect resolve(const Features& f, const plain::Constants& c, const Meeting& at, const StoredView& stored,
                      std::int64_t entry) {
  if (f.rolling)
    return resolve<Features{.dimension = Dimension, .memory = true, .rolling = true}>(c, at, stored, entry);
  if (f.memory) return resolve<Features{.dimension = Dimension, .memory = true}>(c, at, stored, entry);
  return resolve<Features{.dimension = Dimension}>(c, at, stored, entry);
}

ContactEffect resolve(const scene::Scene& scene, const Law& law, const LawConstants& kind, const Meeting& at,
                      const StoredView& stored, std::int64_t entry) {
  const plain::Constants c = plain::constants_of(law, kind, 0.0);
  return scene.container.dimension == 3 ? resolve<3>(scene.features, c, at, stored, entry)
                                        : resolve<2>(scene.features, c, at, stored, entry);
}

plain::Touch touch_of_pair(const scene::Scene& scene, const particles::Store& store, LocalIndex i, LocalIndex j) {
  const Vec3 d = geometry::separation(scene.container, store.position(i), store.position(j));
  const double radii = store.radius(j) + store.radius(i);
  const plain::Separation apart = plain::separation(d[0], d[1], d[2], d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  return {apart.normal, apart.inverse, radii - apart.distance};
}

plain::Reduced reduced_of(const scene::Scene& scene, const Law& law, const particles::Store& store, LocalIndex i,
                          LocalIndex j) {
  const double k = store.record(j)[store.layout().curvature] + store.record(i)[store.layout().curvature];
  return scene.features.mixture
             ? plain::reduced_of_mixed(k, store.substance(i).inverse_mass + store.substance(j).inverse_mass)
             : plain::reduced_of_pair(law.mass_factor, k, store.radius(j) + store.radius(i));
}

}  // namespace

ContactEffect pair_contact(const scene::Scene& scene, const Law& law, const particles::Store& store, LocalIndex i,
                           LocalIndex j, const StoredView& stored, std::int64_t entry) {
  const plain::Touch touch = touch_of_pair(scene, store, i, j);
  const plain::Reduced reduced = reduced_of(scene, law, store, i, j);
  const Vec3 vi = store.velocity(i), vj = store.velocity(j), wi = store.spin(i), wj = store.spin(j);
  Meeting at{reduced, touch.normal, touch.bend, touch.gap < 0.0 ? 0.0 : touch.gap, {}, {}, {}, {}};
  at.v = {vj[0] - vi[0], vj[1] - vi[1], vj[2] - vi[2]};
  at.s = sum(scaled(store.radius(j), vector_of(wj)), store.radius(i), vector_of(wi));
  at.spin = {wj[0] - wi[0], wj[1] - wi[1], wj[2] - wi[2]};
  return resolve(scene, law, law.of_pair(scene::pair_code(store, i, j)), at, stored, entry);
}

double pair_spring_energy(const scene::Scene& scene, const Law& law, const particles::Store& store, LocalIndex i,
                          LocalIndex j, const StoredView& stored, std::int64_t entry) {
  const LawConstants& kind = law.of_pair(scene::pair_code(store, i, j));
  const double radius = reduced_of(scene, law, store, i, j).radius;
  return energy(scene, kind, radius, touch_of_pair(scene, store, i, j), stored, entry);
}

double wall_spring_energy(const scene::Scene& scene, const Law& law, const particles::Store& store, LocalIndex i,
                          const geometry::Facing& wall, const StoredView& stored, std::int64_t entry) {
  const double r = store.radius(i);
  const plain::Touch touch{vector_of(wall.normal), 0.0, r - wall.distance};
  return energy(scene, law.of_wall(scene::wall_code(store, i)), r, touch, stored, entry);
}

ContactEffect wall_contact(const scene::Scene& scene, const Law& law, const particles::Store& store, LocalIndex i,
                           neighbor::Wall wall, const StoredView& stored, std::int64_t entry) {
  return wall_contact(scene, law, store, i, scene.container.facing(wall, store.position(i)), stored, entry);
}

ContactEffect wall_contact(const scene::Scene& scene, const Law& law, const particles::Store& store, LocalIndex i,
                           const geometry::Facing& wall, const StoredView& stored, std::int64_t entry) {
  const double r = store.radius(i);
  const auto& [distance, normal, velocity] = wall;
  const double k = store.record(i)[store.layout().curvature];
  Vec3 v = store.velocity(i);
  for (std::size_t a = 0; a < 3; ++a) v[a] = velocity[a] - v[a];
  const Vector w = vector_of(store.spin(i));
  const particles::Substance made_of = scene.features.mixture ? store.substance(i) : particles::Substance{};
  const Meeting at{scene.features.mixture ? plain::Reduced{r, 1.0 / made_of.inverse_mass}
                                          : plain::reduced_of_wall(law.mass_factor, k, r),
                   vector_of(normal),
                   0.0,
                   distance < r ? r - distance : 0.0,
                   vector_of(v),
                   scaled(r, w),
                   scaled(-1.0, w),
                   {}};
  return resolve(scene, law, law.of_wall(made_of.code), at, stored, entry);
}

}  // namespace packmpi::dynamics
