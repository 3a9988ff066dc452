/// How far from equilibrium the moving particles are.
#include <array>
#include <cmath>
#include <limits>

#include "comm/exact_sum.hpp"
#include "dynamics/contact_law.hpp"
#include "dynamics/kernel.hpp"
#include "dynamics/near_field.hpp"
#include "observe/measure.hpp"
#include "observe/touch.hpp"
#include "scene/mixture.hpp"

namespace packmpi::observe {
namespace {

/// Forces on the owned particles in the scene's force quanta: sums of integers, the same in any order.
class Sums {
 public:
  Sums(const particles::Store& store, const scene::Scene& scene)
      : scene_(&scene),
        each_(static_cast<std::size_t>(dynamics::accumulators_of(store.layout()))),
        sums_(static_cast<std::size_t>(store.owned()) * each_, 0) {}

  void add(LocalIndex i, const Vec3& force, int sign = 1) {
    for (std::size_t a = 0; a < static_cast<std::size_t>(scene_->container.dimension); ++a) {
      sums_[static_cast<std::size_t>(i) * each_ + a] += sign * std::llround(force[a] / scene_->force_quantum);
    }
  }
  [[nodiscard]] double magnitude(LocalIndex i) const {
    double squared = 0.0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(scene_->container.dimension); ++a) {
      const double f = static_cast<double>(sums_[static_cast<std::size_t>(i) * each_ + a]) * scene_->force_quantum;
      squared += f * f;
    }
    return std::sqrt(squared);
  }
  [[nodiscard]] std::int64_t* accumulators() noexcept { return sums_.data(); }

 private:
  const scene::Scene* scene_;
  std::size_t each_;
  std::vector<std::int64_t> sums_;
};

struct Magnitudes {
  comm::ExactSum sum;
  std::int64_t count = 0;
  void add(double magnitude) {
    sum.add(magnitude);
    ++count;
  }
};

double length(const Vec3& f) { return std::sqrt(dot(f, f)); }

/// Weight and drag.
void add_body_forces(const particles::Store& store, const scene::Scene& scene, Sums& sums) {
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  const input::Drag& drag = scene.in.drag;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const Vec3 v = store.velocity(i);
    Vec3 force{};
    for (std::size_t a = 0; a < 3; ++a) force[a] = -drag.coefficient * (v[a] - drag.fluid_velocity[a]);
    force[vertical] -= scene::mass_of(scene, store, i) * scene.in.jamming.gravity;
    sums.add(i, force);
  }
}

/// Each touching pair acts on both its ends that are owned here; its magnitude is counted once over all ranks.
void add_pairs(const particles::Store& store, const scene::Scene& scene, const dynamics::Law& law,
               const neighbor::Neighborhood& neighborhood, GlobalId frozen_below, Sums& sums, Magnitudes& magnitudes) {
  const dynamics::StoredView stored = dynamics::stored_pairs(neighborhood);
  each_touching(store, scene.container, neighborhood.pairs(),
                [&](std::int64_t entry, LocalIndex i, LocalIndex j, double) {
                  const Vec3 force = dynamics::pair_contact(scene, law, store, i, j, stored, entry).force;
                  sums.add(i, force);
                  if (j < store.owned()) sums.add(j, force, -1);
                  if (is_counted_here(store, i, j, frozen_below)) magnitudes.add(length(force));
                });
}

void add_walls(const particles::Store& store, const scene::Scene& scene, const dynamics::Law& law,
               const neighbor::Neighborhood& neighborhood, Sums& sums, Magnitudes& magnitudes) {
  const dynamics::StoredView stored = dynamics::stored_walls(neighborhood);
  each_touching_wall(store, scene.container, neighborhood.walls(),
                     [&](std::int64_t entry, LocalIndex i, neighbor::Wall, const geometry::Facing& at) {
                       const Vec3 force = dynamics::wall_contact(scene, law, store, i, at, stored, entry).force;
                       sums.add(i, force);
                       magnitudes.add(length(force));
                     });
}

}  // namespace

double unbalanced_force(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                        const dynamics::Law& law, const neighbor::Neighborhood& neighborhood, GlobalId frozen_below) {
  Sums sums(store, scene);
  bool in_range = true;
  if (scene.features.near_field) {
    in_range = dynamics::add_near_field(scene, store, neighborhood.near_pairs(), sums.accumulators());
  }
  Magnitudes on_particles, of_contacts;
  add_body_forces(store, scene, sums);
  add_pairs(store, scene, law, neighborhood, frozen_below, sums, of_contacts);
  add_walls(store, scene, law, neighborhood, sums, of_contacts);
  for (LocalIndex i = 0; i < store.owned(); ++i) on_particles.add(sums.magnitude(i));
  std::array<std::int64_t, 3> counts{on_particles.count, of_contacts.count, in_range ? 0 : 1};
  comm.sum(counts);
  std::array terms{on_particles.sum, of_contacts.sum};
  const std::vector<double> totals = comm::exact_sums(comm, terms);
  if (counts[2] > 0) return std::numeric_limits<double>::quiet_NaN();
  if (totals[0] == 0.0) return 0.0;
  if (totals[1] == 0.0) return std::numeric_limits<double>::infinity();
  return totals[0] / static_cast<double>(counts[0]) / (totals[1] / static_cast<double>(counts[1]));
}

}  // namespace packmpi::observe
