#include <cmath>

#include "comm/exact_sum.hpp"
#include "dynamics/contact_law.hpp"
#include "observe/analysis.hpp"
#include "observe/measure.hpp"

namespace packmpi::observe {

Forces forces(const Specimen& pack) {
  constexpr double width = 0.1, most = 8.0;  // of the mean force
  std::vector<comm::ExactSum> terms(19);     // fabric, stress, normal force
  std::vector<double> normals;
  const auto vertical = static_cast<std::size_t>(pack.scene.container.vertical());
  const auto add = [&](const ContactForce& c) {
    if (!pack.bulk.has(c.middle[vertical])) return;
    const Vec3& l = c.branch;
    const double length = std::sqrt(l[0] * l[0] + l[1] * l[1] + l[2] * l[2]);
    double normal = 0.0;
    for (std::size_t a = 0; a < 3; ++a) {
      normal -= c.force[a] * l[a] / length;
      for (std::size_t b = 0; b < 3; ++b) {
        terms[3 * a + b].add(l[a] * l[b] / (length * length));
        terms[9 + 3 * a + b].add(-l[a] * c.force[b]);
      }
    }
    terms[18].add(normal);
    normals.push_back(normal);
  };
  each_contact(pack.store, pack.scene, pack.neighborhood.pairs(), dynamics::stored_pairs(pack.neighborhood), add);
  const std::vector<double> sums = comm::exact_sums(pack.comm, terms);
  Forces result;
  result.contacts = pack.comm.sum(std::ssize(normals));
  if (result.contacts == 0) return result;
  const auto contacts = static_cast<double>(result.contacts);
  const double volume = pack.scene.container.volume_between(pack.bulk.low, pack.bulk.high);
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
