/// A handful of particles and their steps, with every pair and wall listed: physics without neighbour search or ranks.
#pragma once
#include <vector>

#include "dynamics/contact_law.hpp"
#include "dynamics/kernel.hpp"
#include "dynamics/near_field.hpp"
#include "particles/store.hpp"
#include "scene/pair_channels.hpp"
#include "scene/scene.hpp"

namespace packmpi::support {

/// A scene of equal particles in a large box, everything but normal elastic contact off. Change it, then make a World.
inline scene::Scene plain_scene(int dimension, double radius) {
  scene::Scene s;
  s.in.particles.density = 1000.0;
  s.in.particles.youngs_modulus = 1e8;
  s.in.particles.poisson_ratio = 0.25;
  s.in.particles.radius.value = radius;
  s.sizes = scene::Sizes(s.in.particles.radius, 1);
  s.in.contact.tension_cutoff = true;
  s.features = {.dimension = dimension, .rotation = false, .friction = false, .drag = false};
  s.container = {.dimension = dimension, .size = {100.0, 100.0, dimension == 3 ? 100.0 : 0.0}, .periodic = {}};
  s.time_step = 1e-4;
  s.force_quantum = 0x1p-30;  // +-1 MN
  return s;
}

/// Sizes differ: the kernel computes r* and m* of each contact.
inline void make_graded(scene::Scene& s, double smallest, double largest) {
  s.in.particles.radius.distribution = input::SizeDistribution::uniform;
  s.in.particles.radius.min = smallest;
  s.in.particles.radius.max = largest;
  s.sizes = scene::Sizes(s.in.particles.radius, 1);
  s.features.graded = true;
}

inline void add_friction(scene::Scene& s, double coefficient) {
  s.in.contact.friction = coefficient;
  s.in.contact.wall_friction = coefficient;
  s.features.friction = true;
}

/// Friction that remembers, with resistance to rolling and twisting where they are not zero.
inline void add_memory(scene::Scene& s, double friction, double rolling = 0.0, double twisting = 0.0) {
  add_friction(s, friction);
  s.in.contact.tangential = input::Tangential::mindlin;
  s.in.contact.rolling_friction = rolling;
  s.in.contact.twisting_friction = twisting;
  s.features.memory = true;
  s.features.rolling = rolling > 0.0 || twisting > 0.0;
}

class World {
 public:
  explicit World(const scene::Scene& scene)
      : scene_(scene),
        store_(scene.features.layout()),
        law_(dynamics::make_law(scene)),
        kernel_(dynamics::select_kernel(scene.features)) {
    gravity_[static_cast<std::size_t>(scene_.container.vertical())] = -scene_.in.jamming.gravity;
  }

  /// [m/s2], in place of the scene's: a slope is a floor under turned gravity.
  void set_gravity(const Vec3& gravity) { gravity_ = gravity; }

  void add(const Vec3& position, const Vec3& velocity, double radius = 0.0, const Vec3& omega = {}) {
    const double r = radius > 0.0 ? radius : scene_.sizes.largest();
    store_.add(store_.owned(), position, r, velocity, omega);
  }

  /// One step; contacts are those of the positions before it.
  dynamics::StepReport step() {
    list();
    slots_.assign(static_cast<std::size_t>(dynamics::ring_slots(store_.owned())) + 1, Slot{});
    if (scene_.features.near_field) {
      near_in_range_ = dynamics::add_near_field(scene_, store_, pairs_, slots_.front().sums);
    }
    return kernel_(data());
  }
  /// Steps for `time` [s]; the report of the last.
  dynamics::StepReport run(double time) {
    dynamics::StepReport report;
    for (auto left = static_cast<std::int64_t>(time / scene_.time_step + 0.5); left > 0; --left) report = step();
    return report;
  }

  [[nodiscard]] const particles::Store& store() const { return store_; }
  [[nodiscard]] particles::Store& store() { return store_; }
  /// Stored double c of the contact of two particles, listed in ascending order, or of a particle and the floor.
  [[nodiscard]] double stored(std::size_t c, std::size_t pair = 0) const {
    return pair_stored_.at(c * pairs_.first.size() + pair);
  }
  [[nodiscard]] dynamics::StoredView stored_pairs() const { return {pair_stored_.data(), std::ssize(pairs_.first)}; }
  [[nodiscard]] dynamics::StoredView stored_walls() const { return {wall_stored_.data(), std::ssize(walls_.particle)}; }
  [[nodiscard]] const dynamics::Law& law() const { return law_; }
  [[nodiscard]] double stored_at_floor(std::size_t c, std::size_t particle = 0) const {
    return wall_stored_.at(c * walls_.particle.size() + particle);
  }
  [[nodiscard]] const scene::Scene& scene() const { return scene_; }
  [[nodiscard]] Vec3 position(LocalIndex i) const { return store_.position(i); }
  [[nodiscard]] Vec3 velocity(LocalIndex i) const { return store_.velocity(i); }
  [[nodiscard]] double up(LocalIndex i) const {
    return position(i)[static_cast<std::size_t>(scene_.container.vertical())];
  }
  [[nodiscard]] bool near_in_range() const { return near_in_range_; }

 private:
  struct alignas(64) Slot {
    std::int64_t sums[8] = {};
  };

  void list() {
    pairs_ = {};
    walls_ = {};
    for (LocalIndex i = 0; i < store_.owned(); ++i) {
      for (LocalIndex j = i + 1; j < store_.owned(); ++j) pairs_.first.push_back(i), pairs_.second.push_back(j);
      walls_.particle.push_back(i);
      walls_.wall.push_back(neighbor::Wall::floor);
    }
    pairs_.window = store_.owned();
    const auto doubles = static_cast<std::size_t>(scene::stored_doubles(scene_.features));
    pair_stored_.resize(doubles * pairs_.first.size());  // as zeros once all are added; kept from step to step
    wall_stored_.resize(doubles * walls_.particle.size());
  }

  dynamics::StepData data() {
    return {.records = store_.records(),
            .owned = store_.owned(),
            .begin = 0,
            .end = store_.owned(),
            .first = pairs_.first.data(),
            .second = pairs_.second.data(),
            .pairs = static_cast<std::int64_t>(pairs_.first.size()),
            .wall_particle = walls_.particle.data(),
            .wall = walls_.wall.data(),
            .walls = static_cast<std::int64_t>(walls_.particle.size()),
            .ring = slots_.front().sums,
            .ring_mask = dynamics::ring_slots(store_.owned()) - 1,
            .law = law_,
            .force_quantum = scene_.force_quantum,
            .time_step = scene_.time_step,
            .gravity = gravity_,
            .drag = scene_.in.drag.coefficient,
            .fluid_velocity = scene_.in.drag.fluid_velocity,
            .size = scene_.container.size,
            .periodic = scene_.container.periodic,
            .planes = dynamics::planes_of(scene_.container),
            .stored_pairs = {pair_stored_.data(), std::ssize(pairs_.first)},
            .stored_walls = {wall_stored_.data(), std::ssize(walls_.particle)}};
  }

  scene::Scene scene_;
  particles::Store store_;
  dynamics::Law law_;
  dynamics::Kernel kernel_;
  neighbor::PairList pairs_;
  neighbor::WallList walls_;
  std::vector<double> pair_stored_, wall_stored_;
  std::vector<Slot> slots_;
  Vec3 gravity_{};
  bool near_in_range_ = true;
};

}  // namespace packmpi::support
