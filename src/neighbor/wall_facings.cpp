// What each particle touches of a mesh or a polygon, and of a lid on them.
#include <algorithm>
#include <cmath>

#include "mesh/vectors.hpp"
#include "neighbor/neighborhood.hpp"

namespace packmpi::neighbor {
namespace {

constexpr double one_way = 0.7;  // cosine between directions to one and the same wall

/// How much of a face at `far` counts beside one at `near`: all where it is as near; nothing where the particle's foot
/// leaves it across an inner edge towards the other, as there far.distance * cosine is near.distance.
double share(const geometry::Facing& far, const geometry::Facing& near) {
  if (!(far.distance > near.distance)) return 1.0;
  const double cosine = dot(far.normal, near.normal);
  const double above = near.distance - cosine * far.distance;
  return above > 0.0 ? above / (far.distance - cosine * near.distance) : 0.0;
}

/// The entries of one particle of radius r.
struct Touched {
  WallList& walls;
  ContactMemory& memory;
  const mesh::Features& features;
  double r = 0.0;
  std::size_t begin = 0, end = 0;
  std::vector<bool> taken = {};            // of each entry from `begin` on
  std::vector<std::size_t> together = {};  // entries that are one wall

  [[nodiscard]] std::int32_t patch(std::size_t entry) const {
    return features.patch_of(static_cast<std::int32_t>(walls.wall[entry]) -
                             static_cast<std::int32_t>(geometry::most_surfaces));
  }
  /// The nearest entry that is touched and not yet taken; `end`: there is none.
  [[nodiscard]] std::size_t nearest() const {
    std::size_t best = end;
    for (std::size_t k = begin; k < end; ++k) {
      const double here = walls.facing[k].distance;
      if (!taken[k - begin] && here < (best == end ? r : walls.facing[best].distance)) best = k;
    }
    return best;
  }
  void join() {
    taken.assign(end - begin, false);
    for (std::size_t lead = nearest(); lead < end; lead = nearest()) gather(lead);
  }
  /// What the others of its patch and direction do, `lead` does for them.
  void gather(std::size_t lead) {
    const Vec3 normal = walls.facing[lead].normal;
    together.assign(1, lead);
    taken[lead - begin] = true;
    for (std::size_t k = begin; k < end; ++k) {
      if (taken[k - begin] || patch(k) != patch(lead) || !(dot(walls.facing[k].normal, normal) > one_way)) continue;
      taken[k - begin] = true;
      together.push_back(k);
      take_over(lead, k);
    }
    const Vec3 mean = mean_normal();
    for (const std::size_t k : together) {
      if (k != lead) walls.facing[k].distance = mesh::far_away;
    }
    walls.facing[lead].normal = mean;
  }
  /// Weighted by overlaps and shares: what comes and goes has no weight then.
  [[nodiscard]] Vec3 mean_normal() const {
    Vec3 sum{};
    int several = 0;
    for (const std::size_t k : together) {
      const geometry::Facing& one = walls.facing[k];
      double weight = r - one.distance;
      if (!(weight > 0.0)) continue;
      ++several;
      for (const std::size_t other : together) weight *= share(one, walls.facing[other]);
      sum = mesh::plus(sum, mesh::times(weight, one.normal));
    }
    return several > 1 ? mesh::unit(sum) : walls.facing[together.front()].normal;
  }
  void take_over(std::size_t lead, std::size_t other) const {
    if (!memory.in_use()) return;
    const std::size_t entries = walls.particle.size();
    for (std::size_t c = 0; c < memory.doubles(); ++c) {
      double& from = memory.of_walls()[c * entries + other];
      if (from != 0.0) memory.of_walls()[c * entries + lead] += from, from = 0.0;
    }
  }
};

}  // namespace

void Neighborhood::face_walls(const particles::Store& store) {
  const geometry::Container& vessel = scene_->container;
  if (vessel.is_polygon()) {
    walls_.facing.resize(walls_.particle.size());
    for (std::size_t k = 0; k < walls_.particle.size(); ++k) {
      walls_.facing[k] = vessel.facing(walls_.wall[k], store.position(walls_.particle[k]));
    }
  }
  if (!vessel.is_mesh()) return;
  const mesh::Features& features = vessel.interior->features();
  const mesh::Table table = features.table(vessel.deepest);
  const std::size_t entries = walls_.particle.size();
  walls_.facing.resize(entries);
  Touched mine{.walls = walls_, .memory = memory_, .features = features};
  for (mine.begin = 0; mine.begin < entries; mine.begin = mine.end) {
    const LocalIndex i = walls_.particle[mine.begin];
    const double* x = store.record(i);
    mine.r = store.radius(i);
    bool touched = false;
    if (walls_.wall[mine.begin] == Wall::lid) {  // the first of its entries, and no part of the mesh
      walls_.facing[mine.begin] = vessel.facing(Wall::lid, store.position(i));
      ++mine.begin;
    }
    for (mine.end = mine.begin; mine.end < entries && walls_.particle[mine.end] == i; ++mine.end) {
      const std::size_t k = mine.end;
      const auto feature =
          static_cast<std::int32_t>(walls_.wall[k]) - static_cast<std::int32_t>(geometry::most_surfaces);
      const mesh::Touch at =
          mesh::touch(table, feature, walls_.near.data(), walls_.near_begin[k], walls_.near_begin[k + 1], x, mine.r);
      walls_.facing[k] = {at.distance, {at.normal[0], at.normal[1], at.normal[2]}};
      touched = touched || at.distance < mine.r;
    }
    if (touched && mine.end - mine.begin > 1) mine.join();
  }
}

}  // namespace packmpi::neighbor
