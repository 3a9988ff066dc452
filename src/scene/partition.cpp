#include "scene/partition.hpp"

#include <metis.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "base/error.hpp"

namespace packmpi::scene {
namespace {

// METIS goes wrong silently when the weights sum to 2^31 or more: scale to at most 1e8, each at least 1.
std::vector<idx_t> scaled_weights(std::span<const std::int64_t> weights) {
  const auto total = static_cast<double>(std::accumulate(weights.begin(), weights.end(), std::int64_t{0}));
  const double scale = total > 1e8 ? 1e8 / total : 1.0;
  std::vector<idx_t> out(weights.size());
  std::ranges::transform(weights, out.begin(), [scale](std::int64_t w) {
    return static_cast<idx_t>(std::max(1.0, std::floor(static_cast<double>(w) * scale)));
  });
  return out;
}

// Adjacency of the tiles in METIS' compressed form: ghosts across a face weigh ten times those across an edge.
struct Graph {
  std::vector<idx_t> start{0}, neighbor, weight;
};

int wrapped(int i, int n, bool periodic) {
  if (i >= 0 && i < n) return i;
  return periodic && n > 2 ? (i + n) % n : -1;
}

Graph graph_of(const TileGrid& grid) {
  Graph graph;
  for (int iy = 0; iy < grid.ny; ++iy) {
    for (int ix = 0; ix < grid.nx; ++ix) {
      for (int k = 0; k < 9; ++k) {
        const int dx = k % 3 - 1;
        const int dy = k / 3 - 1;
        const int jx = wrapped(ix + dx, grid.nx, grid.periodic_x);
        const int jy = wrapped(iy + dy, grid.ny, grid.periodic_y);
        if (k == 4 || jx < 0 || jy < 0) continue;
        graph.neighbor.push_back(jx + grid.nx * jy);
        graph.weight.push_back(dx == 0 || dy == 0 ? 10 : 1);
      }
      graph.start.push_back(static_cast<idx_t>(graph.neighbor.size()));
    }
  }
  return graph;
}

// Tiles in boustrophedon order, cut into runs of equal weight: always valid, never empty.
std::vector<Rank> snake(const TileGrid& grid, int parts) {
  std::vector<std::size_t> order;
  std::vector<std::int64_t> weights;
  for (int iy = 0; iy < grid.ny; ++iy) {
    for (int k = 0; k < grid.nx; ++k) {
      const int ix = iy % 2 == 0 ? k : grid.nx - 1 - k;
      order.push_back(static_cast<std::size_t>(ix + grid.nx * iy));
      weights.push_back(grid.weights[order.back()]);
    }
  }
  const std::vector<int> cuts = cut_line(weights, parts);
  std::vector<Rank> part(order.size());
  for (int p = 0; p < parts; ++p) {
    for (int k = cuts[static_cast<std::size_t>(p)]; k < cuts[static_cast<std::size_t>(p) + 1]; ++k) {
      part[order[static_cast<std::size_t>(k)]] = p;
    }
  }
  return part;
}

}  // namespace

std::vector<int> cut_line(std::span<const std::int64_t> weights, int parts) {
  const int cells = static_cast<int>(weights.size());
  // Weight as particles + 1 a cell, so that an empty box is cut into equal lengths.
  const std::int64_t total = std::accumulate(weights.begin(), weights.end(), std::int64_t{cells});
  std::vector<int> cuts{0};
  std::int64_t before = 0;  // weight of cells before `cell`
  int cell = 0;
  for (int p = 1; p < parts; ++p) {
    const double target = static_cast<double>(total) * p / parts;
    const int least = cuts.back() + 1;
    const int most = cells - (parts - p);
    while (cell < most) {
      const std::int64_t next = before + weights[static_cast<std::size_t>(cell)] + 1;
      const bool nearer = std::abs(static_cast<double>(next) - target) < std::abs(static_cast<double>(before) - target);
      if (cell >= least && !nearer) break;
      before = next;
      ++cell;
    }
    cuts.push_back(cell);
  }
  cuts.push_back(cells);
  return cuts;
}

std::optional<Factors> factor_ranks(int ranks, int nx, int ny, double length_x, double length_y) {
  std::optional<Factors> best;
  std::pair<double, int> least;  // halo, then how far from square
  for (int px = 1; px <= ranks; ++px) {
    const int py = ranks / px;
    if (px * py != ranks || px > nx || py > ny) continue;
    const double halo = (px > 1 ? length_y / py : 0.0) + (py > 1 ? length_x / px : 0.0);
    const std::pair cost{halo, std::abs(px - py)};
    if (!best || cost < least) {
      best = Factors{px, py};
      least = cost;
    }
  }
  return best;
}

std::vector<Rank> partition_tiles(const TileGrid& grid, int parts) {
  if (parts == 1) return std::vector<Rank>(grid.weights.size(), 0);  // METIS divides by zero here
  Graph graph = graph_of(grid);
  std::vector<idx_t> weights = scaled_weights(grid.weights);
  std::vector<idx_t> part(weights.size());
  std::array<idx_t, METIS_NOPTIONS> options{};
  METIS_SetDefaultOptions(options.data());
  options[METIS_OPTION_NUMBERING] = 0;
  options[METIS_OPTION_SEED] = 1;
  options[METIS_OPTION_UFACTOR] = 10;
  auto vertices = static_cast<idx_t>(weights.size());
  idx_t constraints = 1;
  auto wanted = static_cast<idx_t>(parts);
  idx_t cut = 0;
  const int status = METIS_PartGraphRecursive(&vertices, &constraints, graph.start.data(), graph.neighbor.data(),
                                              weights.data(), nullptr, graph.weight.data(), &wanted, nullptr, nullptr,
                                              options.data(), &cut, part.data());
  std::vector<int> count(static_cast<std::size_t>(parts));
  for (const idx_t p : part) {
    if (status == METIS_OK && p >= 0 && p < parts) ++count[static_cast<std::size_t>(p)];
  }
  if (status != METIS_OK || std::ranges::find(count, 0) != count.end()) return snake(grid, parts);
  return {part.begin(), part.end()};
}

}  // namespace packmpi::scene
