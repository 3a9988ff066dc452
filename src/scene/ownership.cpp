#include "scene/ownership.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>

#include "scene/partition.hpp"

namespace packmpi::scene {
namespace {

constexpr std::int64_t most_tiles = 65536;
constexpr double worthwhile = 0.95;  // a new table must lower the largest share to this

int tile_edge(const geometry::ColumnGrid& grid) {
  const auto [nx, ny] = grid.counts();
  int edge = 1;
  while (std::int64_t{(nx + edge - 1) / edge} * ((ny + edge - 1) / edge) > most_tiles) ++edge;
  return edge;
}

// The longer lateral axis: slabs are cut across it.
std::size_t longer_axis(const geometry::ColumnGrid& grid) {
  return grid.box().lateral_axes() == 2 && grid.box().size[1] > grid.box().size[0] ? 1 : 0;
}

std::array<int, 2> tiles_of(const geometry::ColumnGrid& grid, int edge) {
  const auto [nx, ny] = grid.counts();
  return {(nx + edge - 1) / edge, (ny + edge - 1) / edge};
}

int part_of(const std::vector<int>& cuts, int coordinate) {
  return static_cast<int>(std::ranges::upper_bound(cuts, coordinate) - cuts.begin()) - 1;
}

}  // namespace

std::int64_t most_ranks(const geometry::ColumnGrid& grid, input::Decomposition kind) {
  if (kind == input::Decomposition::slab) return grid.counts()[longer_axis(grid)];
  if (kind == input::Decomposition::pencil) return grid.size();
  const auto [x, y] = tiles_of(grid, tile_edge(grid));
  return std::int64_t{x} * y;
}

// Every rank needs at least one column (METIS: one tile).
void check_ranks(const geometry::ColumnGrid& grid, input::Decomposition kind, int ranks) {
  const auto [nx, ny] = grid.counts();
  const std::int64_t most = most_ranks(grid, kind);
  std::string words;
  if (kind == input::Decomposition::slab && ranks > most) {
    words = fmt::format(
        "slabs would be thinner than one interaction range: this scene has {} columns along its longer axis, so "
        "use at most {} ranks",
        most, most);
    if (ny > 1) {
      words += fmt::format(", or decomposition = \"pencil\" (at most {} ranks)",
                           most_ranks(grid, input::Decomposition::pencil));
    }
  } else if (kind == input::Decomposition::pencil &&
             !factor_ranks(ranks, nx, ny, grid.box().size[0], grid.box().size[1])) {
    words = fmt::format(
        "{} ranks cannot be laid out as Px x Py over {} x {} columns one interaction range wide; use at most {} "
        "ranks, with a divisor that fits",
        ranks, nx, ny, most);
  } else if (kind == input::Decomposition::metis && ranks > most) {
    words = fmt::format("more ranks than columns: use at most {} ranks", most);
  }
  if (!words.empty()) throw Error(ExitCode::bad_input, "parallel.decomposition: " + words);
}

Ownership::Ownership(const comm::Comm& comm, const geometry::ColumnGrid& grid, input::Decomposition kind)
    : comm_(&comm), grid_(grid), kind_(kind), tile_(kind == input::Decomposition::metis ? tile_edge(grid) : 1) {
  comm::agree_on(comm, [&] { check_ranks(grid_, kind_, comm.size()); });
  table_ = cut(std::vector<std::int64_t>(weight_count(), 0));
  collect();
  if (!grid.box().is_box()) rebalance(room());
}

// How much of each of this rank's columns is inside a round vessel up to H_d: particles come where there is room.
std::vector<std::int64_t> Ownership::room() const {
  constexpr int side = 4;
  const geometry::Container& vessel = grid_.box();
  const int floors = vessel.straight() ? 1 : 8;
  const auto [wx, wy] = grid_.widths();
  std::vector<std::int64_t> points;
  points.reserve(columns_.size());
  for (const geometry::ColumnIndex column : columns_) {
    const geometry::ColumnIndex row = column / grid_.counts()[0];
    const auto ix = static_cast<double>(column % grid_.counts()[0]), iy = static_cast<double>(row);
    std::int64_t inside = 0;
    for (int k = 0; k < side * side * floors; ++k) {
      const int line = k / side % side, floor = k / (side * side);
      const double z = (floor + 0.5) / floors * vessel.height();
      const Vec3 x = vessel.at((ix + (k % side + 0.5) / side) * wx, (iy + (line + 0.5) / side) * wy, z);
      if (vessel.holds(x, 0.0)) ++inside;
    }
    points.push_back(inside);
  }
  return points;
}

std::size_t Ownership::long_axis() const { return longer_axis(grid_); }

std::array<int, 2> Ownership::tiles() const { return tiles_of(grid_, tile_); }

// Weights are summed per line of columns (slab), per line on both axes (pencil) or per tile (METIS).
std::size_t Ownership::weight_count() const {
  const auto [nx, ny] = grid_.counts();
  switch (kind_) {
    case input::Decomposition::slab:
      return static_cast<std::size_t>(grid_.counts()[long_axis()]);
    case input::Decomposition::pencil:
      return static_cast<std::size_t>(nx) + static_cast<std::size_t>(ny);
    case input::Decomposition::metis:
      return static_cast<std::size_t>(tiles()[0]) * static_cast<std::size_t>(tiles()[1]);
  }
  return 0;
}

Ownership::Table Ownership::cut(std::span<const std::int64_t> weights) const {
  const auto [nx, ny] = grid_.counts();
  const int ranks = comm_->size();
  Table table;
  if (kind_ == input::Decomposition::slab) {
    table.cuts_x = {0, nx};
    table.cuts_y = {0, ny};
    (long_axis() == 0 ? table.cuts_x : table.cuts_y) = cut_line(weights, ranks);
  } else if (kind_ == input::Decomposition::pencil) {
    const Factors parts = factor_ranks(ranks, nx, ny, grid_.box().size[0], grid_.box().size[1]).value();
    table.cuts_x = cut_line(weights.first(static_cast<std::size_t>(nx)), parts.x);
    table.cuts_y = cut_line(weights.subspan(static_cast<std::size_t>(nx)), parts.y);
  } else {
    std::string bytes;  // METIS runs on rank 0 only: its answer must not depend on the library of another node
    if (comm_->rank() == 0) {
      TileGrid tile_grid{tiles()[0], tiles()[1], grid_.box().periodic[0], grid_.box().periodic[1], {}};
      tile_grid.weights.assign(weights.begin(), weights.end());
      const std::vector<Rank> owner = partition_tiles(tile_grid, ranks);
      bytes.assign(reinterpret_cast<const char*>(owner.data()), owner.size() * sizeof(Rank));
    }
    bytes = comm_->broadcast(0, bytes);
    table.tiles.resize(bytes.size() / sizeof(Rank));
    std::memcpy(table.tiles.data(), bytes.data(), bytes.size());
  }
  return table;
}

Rank Ownership::owner(geometry::ColumnIndex column) const noexcept { return owner(table_, column); }

Rank Ownership::owner(const Table& table, geometry::ColumnIndex column) const noexcept {
  const int nx = grid_.counts()[0];
  const auto ix = static_cast<int>(column % nx);
  const auto iy = static_cast<int>(column / nx);
  if (kind_ == input::Decomposition::metis) {
    return table.tiles[static_cast<std::size_t>(ix / tile_) +
                       static_cast<std::size_t>(tiles()[0]) * static_cast<std::size_t>(iy / tile_)];
  }
  const int parts_x = static_cast<int>(table.cuts_x.size()) - 1;
  return part_of(table.cuts_x, ix) + parts_x * part_of(table.cuts_y, iy);
}

std::array<int, 2> Ownership::part() const noexcept {
  if (kind_ == input::Decomposition::metis) return {0, 0};
  const int parts_x = static_cast<int>(table_.cuts_x.size()) - 1;
  return {comm_->rank() % parts_x, comm_->rank() / parts_x};
}

void Ownership::collect() {
  columns_.clear();
  neighbors_.clear();
  const auto [nx, ny] = grid_.counts();
  // Slab and pencil parts are rectangles: walk only those. METIS parts have any shape: walk the whole grid.
  int x0 = 0, x1 = nx, y0 = 0, y1 = ny;
  if (kind_ != input::Decomposition::metis) {
    const auto px = static_cast<std::size_t>(part()[0]);
    const auto py = static_cast<std::size_t>(part()[1]);
    x0 = table_.cuts_x[px], x1 = table_.cuts_x[px + 1];
    y0 = table_.cuts_y[py], y1 = table_.cuts_y[py + 1];
  }
  std::vector<geometry::ColumnIndex> touching;
  for (int iy = y0; iy < y1; ++iy) {
    for (int ix = x0; ix < x1; ++ix) {
      const geometry::ColumnIndex column = grid_.index(ix, iy);
      if (owner(column) != comm_->rank()) continue;
      columns_.push_back(column);
      grid_.neighbors(column, touching);
      for (const geometry::ColumnIndex other : touching) neighbors_.push_back(owner(other));
    }
  }
  std::ranges::sort(neighbors_);
  neighbors_.erase(std::unique(neighbors_.begin(), neighbors_.end()), neighbors_.end());
  std::erase(neighbors_, comm_->rank());
}

bool Ownership::rebalance(std::span<const std::int64_t> mine) {
  if (comm_->size() == 1) return false;
  std::vector<std::int64_t> weights(weight_count(), 0);
  const int nx = grid_.counts()[0];
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const auto ix = static_cast<std::size_t>(columns_[k] % nx);
    const auto iy = static_cast<std::size_t>(columns_[k] / nx);
    const auto t = static_cast<std::size_t>(tile_);
    switch (kind_) {
      case input::Decomposition::slab:
        weights[long_axis() == 0 ? ix : iy] += mine[k];
        break;
      case input::Decomposition::pencil:
        weights[ix] += mine[k];
        weights[static_cast<std::size_t>(nx) + iy] += mine[k];
        break;
      case input::Decomposition::metis:
        weights[ix / t + static_cast<std::size_t>(tiles()[0]) * (iy / t)] += mine[k];
        break;
    }
  }
  comm_->sum(weights);
  const Table table = cut(weights);
  if (!worth_it(table, mine)) return false;
  table_ = table;
  collect();
  return true;
}

// Shares under the new table, from what each rank knows: the weights it would hand to each neighbouring part.
bool Ownership::worth_it(const Table& table, std::span<const std::int64_t> mine) const {
  std::vector<std::int64_t> share(static_cast<std::size_t>(comm_->size()), 0);
  std::int64_t now = 0;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    share[static_cast<std::size_t>(owner(table, columns_[k]))] += mine[k];
    now += mine[k];
  }
  comm_->sum(share);
  const auto largest_new = static_cast<double>(std::ranges::max(share));
  return largest_new < worthwhile * static_cast<double>(comm_->max(now));
}

}  // namespace packmpi::scene
