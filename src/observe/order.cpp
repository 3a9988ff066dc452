#include <algorithm>
#include <array>
#include <cmath>

#include "comm/exact_sum.hpp"
#include "geometry/container.hpp"
#include "observe/around.hpp"

namespace packmpi::observe {
namespace {

constexpr double first_shell = 1.2071067811865475;  // (1 + sqrt 2) / 2

// From i to each of its neighbours [m].
std::vector<Vec3> bonds(const Specimen& pack, LocalIndex i, std::span<const LocalIndex> neighbours) {
  std::vector<Vec3> d;
  for (const LocalIndex j : neighbours) {
    d.push_back(geometry::separation(pack.scene.container, pack.store.position(i), pack.store.position(j)));
  }
  return d;
}

// Mean of e^(6 i phi) over the bonds: (x + i y)^6 / r^6.
std::array<double, 2> hexatic(const std::vector<Vec3>& d) {
  double real = 0.0, imaginary = 0.0;
  for (const Vec3& b : d) {
    const double r = std::sqrt(dot(b, b));
    const double x = b[0] / r, y = b[1] / r;
    const double x2 = x * x - y * y, y2 = 2.0 * x * y;  // squared
    real += x2 * x2 * x2 - 3.0 * x2 * y2 * y2;          // and cubed
    imaginary += 3.0 * x2 * x2 * y2 - y2 * y2 * y2;
  }
  const double n = static_cast<double>(std::max<std::size_t>(1, d.size()));
  return {real / n, imaginary / n};
}

// Steinhardt's q_4 and q_6 by the addition theorem: q_l^2 = mean over all pairs of bonds of P_l(cos angle).
std::array<double, 2> steinhardt(const std::vector<Vec3>& d) {
  double sum4 = 0.0, sum6 = 0.0;
  for (const Vec3& a : d) {
    for (const Vec3& b : d) {
      const double c = dot(a, b) / std::sqrt(dot(a, a) * dot(b, b));
      const double c2 = c * c;
      sum4 += (35.0 * c2 * c2 - 30.0 * c2 + 3.0) / 8.0;
      sum6 += (231.0 * c2 * c2 * c2 - 315.0 * c2 * c2 + 105.0 * c2 - 5.0) / 16.0;
    }
  }
  const double n = static_cast<double>(std::max<std::size_t>(1, d.size()));
  return {std::sqrt(std::max(0.0, sum4)) / n, std::sqrt(std::max(0.0, sum6)) / n};
}

enum class Lattice { none, fcc, hcp };

// Common-neighbour analysis of twelve neighbours: fcc, each bond is a 421; hcp, six are 421 and six 422.
Lattice lattice_of(const Specimen& pack, std::span<const LocalIndex> neighbours, const std::vector<Vec3>& d) {
  if (neighbours.size() != 12) return Lattice::none;
  std::array<std::array<bool, 12>, 12> bonded{};
  for (std::size_t a = 0; a < 12; ++a) {
    for (std::size_t b = 0; b < 12; ++b) {
      const Vec3 between{d[b][0] - d[a][0], d[b][1] - d[a][1], d[b][2] - d[a][2]};
      const double reach = first_shell * (pack.store.radius(neighbours[a]) + pack.store.radius(neighbours[b]));
      bonded[a][b] = a != b && dot(between, between) < reach * reach;
    }
  }
  int fcc_bonds = 0, hcp_bonds = 0;
  for (std::size_t a = 0; a < 12; ++a) {
    std::vector<std::size_t> common;
    for (std::size_t b = 0; b < 12; ++b) {
      if (bonded[a][b]) common.push_back(b);
    }
    if (common.size() != 4) return Lattice::none;
    int links = 0;
    std::array<int, 4> degree{};
    for (std::size_t p = 0; p < 4; ++p) {
      for (std::size_t q = p + 1; q < 4; ++q) {
        if (!bonded[common[p]][common[q]]) continue;
        ++links;
        ++degree[p], ++degree[q];
      }
    }
    if (links != 2) return Lattice::none;
    const bool chain = *std::ranges::max_element(degree) == 2;  // the two links share an end: 422
    ++(chain ? hcp_bonds : fcc_bonds);
  }
  if (fcc_bonds == 12) return Lattice::fcc;
  return fcc_bonds == 6 && hcp_bonds == 6 ? Lattice::hcp : Lattice::none;
}

}  // namespace

Order order(const Specimen& pack) {
  const Around around(pack, first_shell);
  const auto vertical = static_cast<std::size_t>(pack.scene.container.vertical());
  const bool plane = pack.scene.container.dimension == 2;
  std::vector<comm::ExactSum> terms(3);  // 2D: |psi|, its parts; 3D: q4, q6
  std::array<std::int64_t, 3> counts{};  // counted, fcc, hcp
  for (LocalIndex i = 0; i < pack.store.owned(); ++i) {
    if (!pack.bulk.has(pack.store.position(i)[vertical])) continue;
    const auto neighbours = around.of(i);
    const std::vector<Vec3> d = bonds(pack, i, neighbours);
    ++counts[0];
    if (plane) {
      const auto [real, imaginary] = hexatic(d);
      terms[0].add(std::sqrt(real * real + imaginary * imaginary));
      terms[1].add(real);
      terms[2].add(imaginary);
    } else {
      const auto [q4, q6] = steinhardt(d);
      terms[0].add(q4);
      terms[1].add(q6);
      const Lattice lattice = lattice_of(pack, neighbours, d);
      counts[1] += lattice == Lattice::fcc ? 1 : 0;
      counts[2] += lattice == Lattice::hcp ? 1 : 0;
    }
  }
  const std::vector<double> sums = comm::exact_sums(pack.comm, terms);
  pack.comm.sum(std::span(counts));
  Order result;
  result.counted = counts[0];
  const double n = static_cast<double>(std::max<std::int64_t>(1, counts[0]));
  if (plane) {
    result.psi6 = sums[0] / n;
    result.psi6_together = std::sqrt(sums[1] * sums[1] + sums[2] * sums[2]) / n;
  } else {
    result.q4 = sums[0] / n;
    result.q6 = sums[1] / n;
    result.fcc = static_cast<double>(counts[1]) / n;
    result.hcp = static_cast<double>(counts[2]) / n;
  }
  return result;
}

}  // namespace packmpi::observe
