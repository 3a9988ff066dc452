// Particles placed by hand, stepped as a run steps them: kernel, ghosts, lists.
#pragma once
#include <array>
#include <cstring>

#include "run/bed.hpp"
#include "support/scenes.hpp"

namespace packmpi::test {

/// A bed of particles placed by hand. Ids in order of placing.
class Bench {
 public:
  Bench(const comm::Comm& comm, const input::Input& in) : scene_(scene::build(in)), bed_(comm, scene_) {}

  void place(const Vec3& x, double r, const Vec3& v = {}, const Vec3& omega = {}) {
    const auto column = bed_.ownership.grid().column(x);
    if (bed_.ownership.owner(column) == bed_.comm.rank()) bed_.store.add(bed_.progress.count, x, r, v, omega);
    ++bed_.progress.count;
  }
  void start() { bed_.neighborhood.rebuild(bed_.store); }
  void step(std::int64_t steps = 1) { bed_.stepper.advance(bed_.store, bed_.neighborhood, steps); }
  [[nodiscard]] const run::Bed& bed() const { return bed_; }
  [[nodiscard]] const scene::Scene& scene() const { return scene_; }
  [[nodiscard]] particles::Store& store() { return bed_.store; }
  [[nodiscard]] neighbor::Neighborhood& neighborhood() { return bed_.neighborhood; }
  [[nodiscard]] double dt() const { return scene_.time_step; }

  struct State {
    Vec3 x, v, omega;
  };
  /// State of a particle, on every rank (the bits travel in an integer sum: one owner).
  [[nodiscard]] State state(GlobalId id) const {
    std::array<std::int64_t, 9> bits{};
    for (LocalIndex i = 0; i < bed_.store.owned(); ++i) {
      if (bed_.store.ids()[static_cast<std::size_t>(i)] != id) continue;
      const State s{bed_.store.position(i), bed_.store.velocity(i), bed_.store.spin(i)};
      static_assert(sizeof s == sizeof bits);
      std::memcpy(bits.data(), &s, sizeof s);
    }
    bed_.comm.sum(bits);
    State s{};
    std::memcpy(static_cast<void*>(&s), bits.data(), sizeof s);
    return s;
  }
  [[nodiscard]] double force() const { return bed_.comm.max(bed_.stepper.last().max_force); }

 private:
  scene::Scene scene_;
  run::Bed bed_;
};

/// No gravity, damping, friction, drag: only what a test adds. The rank border is at half the length.
inline input::Input vacuum(int dimension, double length, double r, double dt, double speed) {
  input::Input in = small_input(dimension, length, r);
  in.jamming.gravity = 0.0;
  in.layers.velocity = {speed, 0.0, 0.0};  // eq. (23) and the range of the force sums want it
  in.contact.damping_ratio = in.contact.friction = in.contact.wall_friction = 0.0;
  in.dynamics.time_step = dt;
  return in;
}

}  // namespace packmpi::test
