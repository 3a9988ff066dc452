#include <algorithm>
#include <cmath>

#include "observe/analysis.hpp"
#include "observe/measure.hpp"
#include "observe/touch.hpp"

namespace packmpi::observe {
namespace {

// Touching pairs of slots: a pair across a rank border is on both ranks, its owned end first.
std::vector<std::array<LocalIndex, 2>> touching(const Specimen& pack) {
  std::vector<std::array<LocalIndex, 2>> found;
  const neighbor::PairList& pairs = pack.neighborhood.pairs();
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    if (touch(pack.store, pack.scene.box, pairs.first[p], pairs.second[p]).overlap > 0.0) {
      found.push_back({pairs.first[p], pairs.second[p]});
    }
  }
  return found;
}

std::vector<int> wall_contacts(const Specimen& pack) {
  std::vector<int> count(static_cast<std::size_t>(pack.store.owned()), 0);
  const neighbor::WallList& walls = pack.neighborhood.walls();
  for (std::size_t w = 0; w < walls.particle.size(); ++w) {
    const LocalIndex i = walls.particle[w];
    if (wall_penetration(pack.store, pack.scene.box, i, walls.wall[w]) > 0.0) ++count[static_cast<std::size_t>(i)];
  }
  return count;
}

}  // namespace

Network network(const Specimen& pack) {
  const auto owned = static_cast<std::size_t>(pack.store.owned());
  const auto contacts = touching(pack);
  const std::vector<int> at_walls = wall_contacts(pack);
  const int needed = pack.scene.box.dimension;  // gravity is one more
  std::vector<std::int64_t> held(static_cast<std::size_t>(pack.store.total()), 1);
  std::vector<std::int64_t> count(owned);
  const auto recount = [&] {
    std::ranges::fill(count, 0);
    for (const auto& [i, j] : contacts) {
      const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(j);
      if (held[a] == 0 || held[b] == 0) continue;
      ++count[a];
      if (b < owned) ++count[b];
    }
  };
  const auto particles =
      static_cast<double>(std::max<std::int64_t>(1, pack.comm.sum(std::int64_t{pack.store.owned()})));
  Network result;
  recount();
  std::array<std::int64_t, 2> sums{};  // contacts, loose
  for (std::size_t i = 0; i < owned; ++i) {
    sums[0] += count[i];
    sums[1] += count[i] + at_walls[i] < needed ? 1 : 0;
  }
  pack.comm.sum(std::span(sums));
  result.coordination = static_cast<double>(sums[0]) / particles;
  result.loose = static_cast<double>(sums[1]) / particles;
  for (std::int64_t released = 1; released > 0;) {  // ends: every turn but the last releases a particle
    std::int64_t mine = 0;
    for (std::size_t i = 0; i < owned; ++i) {
      if (held[i] == 0 || count[i] + at_walls[i] >= needed) continue;
      held[i] = 0;
      ++mine;
    }
    released = pack.comm.sum(mine);
    pack.neighborhood.share(std::span(held));
    recount();
  }
  std::array<std::int64_t, 2> rest{};  // held, contacts between them
  for (std::size_t i = 0; i < owned; ++i) {
    rest[0] += held[i];
    rest[1] += held[i] != 0 ? count[i] : 0;
  }
  pack.comm.sum(std::span(rest));
  result.rattlers = 1.0 - static_cast<double>(rest[0]) / particles;
  result.held_coordination = rest[0] > 0 ? static_cast<double>(rest[1]) / static_cast<double>(rest[0]) : 0.0;
  return result;
}

Forces forces(const Specimen& pack) {
  constexpr double width = 0.1, most = 8.0;    // of the mean force
  std::vector<std::vector<double>> terms(19);  // fabric, stress, normal force
  std::vector<double> normals;
  for (const ContactForce& c :
       contact_forces(pack.store, pack.scene, pack.neighborhood.pairs(), dynamics::stored_pairs(pack.neighborhood))) {
    if (!in_bulk(pack.scene, c.middle[static_cast<std::size_t>(pack.scene.box.vertical())])) continue;
    const Vec3& l = c.branch;
    const double length = std::sqrt(l[0] * l[0] + l[1] * l[1] + l[2] * l[2]);
    double normal = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      normal -= c.force[a] * l[a] / length;
      for (std::size_t b = 0; b < 3; ++b) {
        terms[3 * a + b].push_back(l[a] * l[b] / (length * length));
        terms[9 + 3 * a + b].push_back(-l[a] * c.force[b]);
      }
    }
    terms[18].push_back(normal);
    normals.push_back(normal);
  }
  const std::vector<double> sums = comm::exact_sums(pack.comm, terms);
  Forces result;
  result.contacts = pack.comm.sum(std::ssize(normals));
  if (result.contacts == 0) return result;
  const auto contacts = static_cast<double>(result.contacts);
  const double volume = pack.scene.box.floor_area() * 0.6 * pack.scene.box.height();
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      result.fabric[a][b] = sums[3 * a + b] / contacts;
      result.stress[a][b] = sums[9 + 3 * a + b] / volume;
    }
  }
  result.mean_normal_force = sums[18] / contacts;
  std::vector<std::int64_t> counts(static_cast<std::size_t>(most / width), 0);
  for (const double f : normals) {
    const double share = f / result.mean_normal_force;
    if (share >= 0.0 && share < most) ++counts[static_cast<std::size_t>(share / width)];
  }
  pack.comm.sum(std::span(counts));
  result.distribution.width = width;
  for (const std::int64_t count : counts) {
    result.distribution.values.push_back(static_cast<double>(count) / (contacts * width));
  }
  return result;
}

}  // namespace packmpi::observe
