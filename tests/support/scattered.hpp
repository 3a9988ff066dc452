/// Hand-made particles spread over the ranks, with ghosts and lists by brute force: the slow, obvious twin of the halo.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "comm/comm.hpp"
#include "geometry/container.hpp"
#include "neighbor/lists.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::testing {

/// A particle; its id is its place in the vector.
struct Grain {
  Vec3 x{};
  double r = 0.0;
  Vec3 v{};
  Vec3 w{};
};

/// Ways to spread: all on the last rank; over every other rank, so that some are empty; over all; in runs of ids.
enum class Spread { last, some, all, runs };
inline constexpr Spread every_spread[] = {Spread::last, Spread::some, Spread::all, Spread::runs};

inline Rank owner_of(std::size_t id, std::size_t count, int ranks, Spread spread) {
  const auto hash = static_cast<std::uint32_t>((id + 1) * 2654435761u) >> 8;
  switch (spread) {
    case Spread::last:
      return ranks - 1;
    case Spread::some:
      return static_cast<Rank>(hash % static_cast<std::uint32_t>((ranks + 1) / 2)) * 2;
    case Spread::all:
      return static_cast<Rank>(hash % static_cast<std::uint32_t>(ranks));
    case Spread::runs:
      return static_cast<Rank>(id * static_cast<std::size_t>(ranks) / count);
  }
  return 0;
}

/// This rank's store: its own in descending order of id, then everybody else's as ghosts.
inline particles::Store scattered(const comm::Comm& comm, const particles::Layout& layout,
                                  const std::vector<Grain>& grains, Spread spread) {
  particles::Store store(layout);
  particles::Store others(layout);
  for (std::size_t k = grains.size(); k-- > 0;) {
    particles::Store& to = owner_of(k, grains.size(), comm.size(), spread) == comm.rank() ? store : others;
    to.add(static_cast<GlobalId>(k), grains[k].x, grains[k].r, grains[k].v, grains[k].w);
  }
  store.set_ghosts(others.owned());
  for (LocalIndex g = 0; g < others.owned(); ++g) {
    const LocalIndex slot = store.owned() + g;
    std::copy(others.record(g), others.record(g) + layout.stride, store.record(slot));
    store.ids()[static_cast<std::size_t>(slot)] = others.ids()[static_cast<std::size_t>(g)];
  }
  return store;
}

inline neighbor::PairList all_pairs(const particles::Store& store) {
  neighbor::PairList pairs;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    for (LocalIndex j = i + 1; j < store.total(); ++j) {
      pairs.first.push_back(i);
      pairs.second.push_back(j);
    }
  }
  return pairs;
}

inline neighbor::WallList all_walls(const particles::Store& store, const geometry::Container& box) {
  neighbor::WallList walls;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    for (int wall = 0; wall <= 2 * box.lateral_axes(); ++wall) {
      if (wall > 0 && box.periodic[static_cast<std::size_t>((wall - 1) / 2)]) continue;
      walls.particle.push_back(i);
      walls.wall.push_back(static_cast<neighbor::Wall>(wall));
    }
  }
  return walls;
}

/// A scene of equal particles, without the input module.
inline scene::Scene make_scene(int dimension, const Vec3& size, std::array<bool, 2> periodic, double largest_radius) {
  scene::Scene scene;
  scene.in.particles.density = 1000.0;
  scene.in.particles.youngs_modulus = 1.0e8;
  scene.in.particles.poisson_ratio = 0.25;
  scene.in.particles.radius.value = largest_radius;
  scene.in.contact.damping_ratio = 0.1;
  scene.in.contact.friction = 0.2;
  scene.in.contact.wall_friction = 0.2;
  scene.in.jamming.gravity = 2.0;
  scene.container = {.dimension = dimension, .size = size, .periodic = periodic};
  scene.features = {.dimension = dimension};
  scene.sizes = scene::Sizes(scene.in.particles.radius, 1);
  scene.time_step = 1.0e-4;
  return scene;
}

/// A small generator of its own, good enough to scatter things: numbers in [0, 1).
class Scatter {
 public:
  double operator()() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state_ >> 11) * 0x1p-53;
  }

 private:
  std::uint64_t state_ = 42;
};

}  // namespace packmpi::testing
