// The Verlet lists from the sorted cells: the hot part of a rebuild.
#include <algorithm>

#include "base/grow.hpp"
#include "neighbor/neighborhood.hpp"

namespace packmpi::neighbor {
namespace {

// What one search needs, by value so that the inner loop keeps it in registers.
struct Search {
  const double* x;
  const double* y;
  const double* z;            // null in 2D
  const double* extent;       // how far each reaches; not for the near field
  double reach;               // the cut-off of the near field
  double period_x, period_y;  // 0: wall
};

// Slots of [begin, end) within the cut-off of slot i, appended at out; returns the new end. Branch-free: each candidate
// is written and kept by moving the end.
template <bool Near, bool Periodic, bool ThreeD>
LocalIndex* find(const Search& s, LocalIndex i, LocalIndex begin, LocalIndex end, LocalIndex* out) {
  const double xi = s.x[i];
  const double yi = s.y[i];
  const double zi = ThreeD ? s.z[i] : 0.0;
  const double base = Near ? s.reach : s.extent[i];
  for (LocalIndex j = begin; j < end; ++j) {
    double dx = s.x[j] - xi;
    double dy = s.y[j] - yi;
    if constexpr (Periodic) {
      if (s.period_x > 0.0) dx = geometry::shortest(dx, s.period_x);
      if (ThreeD && s.period_y > 0.0) dy = geometry::shortest(dy, s.period_y);
    }
    double squared = dx * dx + dy * dy;
    if constexpr (ThreeD) squared += (s.z[j] - zi) * (s.z[j] - zi);
    const double cut = Near ? base : base + s.extent[j];
    *out = j;
    out += static_cast<int>(squared < cut * cut);
  }
  return out;
}

using Find = LocalIndex* (*)(const Search&, LocalIndex, LocalIndex, LocalIndex, LocalIndex*);

Find choose(bool near, bool periodic, bool three_d) {
  if (three_d) {
    if (near) return periodic ? find<true, true, true> : find<true, false, true>;
    return periodic ? find<false, true, true> : find<false, false, true>;
  }
  if (near) return periodic ? find<true, true, false> : find<true, false, false>;
  return periodic ? find<false, true, false> : find<false, false, false>;
}

}  // namespace

// Where the partners of cell (column c, level k) are, but those in its own column: columns ahead of it, ghosts, and
// what stands still around.
void Neighborhood::find_runs(int c, std::size_t k, std::vector<Run>& runs) const {
  const auto levels = static_cast<std::size_t>(cells_.levels);
  const std::size_t low = k > 0 ? k - 1 : 0;
  const std::size_t high = std::min(k + 2, levels);
  runs.clear();
  const auto add = [&](const Cells& cells, int column) {
    const auto at = static_cast<std::size_t>(column) * levels;
    if (cells.start[at + low] < cells.start[at + high]) runs.push_back({cells.start[at + low], cells.start[at + high]});
  };
  for (const int other : columns_.forward(c)) add(cells_, other);
  if (!frozen_.in_use()) return;
  add(frozen_cells_, c);
  for (const int other : columns_.around(c)) add(frozen_cells_, other);
}

// Pairs that may come to touch, or, with a cut-off between centres, those of the near field.
void Neighborhood::build_pairs(const particles::Store& store, std::optional<double> cutoff, PairList& list) {
  const geometry::Container& box = scene_->container;
  const Search s{x_[0].data(),
                 x_[1].data(),
                 x_[2].data(),
                 extent_.data(),
                 cutoff.value_or(0.0) + 2.0 * margins_.most(),
                 box.periodic[0] ? box.size[0] : 0.0,
                 box.dimension == 3 && box.periodic[1] ? box.size[1] : 0.0};
  const Find find_in = choose(cutoff.has_value(), scene_->features.periodic, box.dimension == 3);

  std::size_t size = 0;
  LocalIndex window = 1;
  std::int64_t looked_at = 0;
  std::vector<Run> runs;
  const auto levels = static_cast<std::size_t>(cells_.levels);
  for (int c = 0; c < columns_.own(); ++c) {
    const auto column = static_cast<std::size_t>(c) * levels;
    for (std::size_t k = 0; k < levels; ++k) {
      if (cells_.start[column + k] == cells_.start[column + k + 1]) continue;
      const LocalIndex own_end = cells_.start[column + std::min(k + 2, levels)];
      find_runs(c, k, runs);
      auto candidates = static_cast<std::size_t>(own_end - cells_.start[column + k]);
      for (const auto& [from, to] : runs) candidates += static_cast<std::size_t>(to - from);
      for (LocalIndex i = cells_.start[column + k]; i < cells_.start[column + k + 1]; ++i) {
        if (list.second.size() < size + candidates) {
          resize_tightly(list.second, size + candidates + 4096);
          list.second.resize(list.second.capacity());
        }
        LocalIndex* const begin = list.second.data() + size;
        LocalIndex* out = find_in(s, i, i + 1, own_end, begin);
        for (const auto& [from, to] : runs) out = find_in(s, i, from, to, out);
        looked_at += static_cast<std::int64_t>(candidates) - (i - cells_.start[column + k]) - 1;
        const auto found = static_cast<std::size_t>(out - begin);
        if (list.first.size() < size + found) {
          resize_tightly(list.first, size + found + 4096);
          list.first.resize(list.first.capacity());
        }
        std::fill_n(list.first.data() + size, found, i);
        for (const LocalIndex* j = begin; j < out; ++j) {
          if (*j < store.owned()) window = std::max(window, *j - i + 1);
        }
        size += found;
      }
    }
  }
  list.first.resize(size);
  list.second.resize(size);
  list.window = window;
  if (!cutoff) candidates_ = looked_at;
}

void Neighborhood::build_walls(const particles::Store& store) {
  walls_.particle.clear();
  walls_.wall.clear();
  const double walls_move = scene_->in.confinement ? 0.5 * scene_->skin : 0.0;
  if (scene_->container.is_mesh()) return build_features(store, walls_move);
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const double range = extent_[static_cast<std::size_t>(i)] + walls_move;
    scene_->container.near_walls(store.position(i), range, [&](Wall wall, double) {
      walls_.particle.push_back(i);
      walls_.wall.push_back(wall);
    });
  }
}

// The lid, and the faces, edges and corners of a mesh.
void Neighborhood::build_features(const particles::Store& store, double lid_moves) {
  const geometry::Container& vessel = scene_->container;
  walls_.near.clear();
  walls_.near_begin.assign(1, 0);
  near_memory_.begin();
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const Vec3 x = store.position(i);
    const double extent = extent_[static_cast<std::size_t>(i)];
    const auto before = static_cast<std::int32_t>(walls_.near.size());
    if (vessel.lid && vessel.plane(Wall::lid).distance(x) < extent + lid_moves) {
      walls_.particle.push_back(i);
      walls_.wall.push_back(Wall::lid);
      walls_.near_begin.push_back(before);
    }
    const mesh::NearFeatures& found = near_memory_.near(*vessel.interior, store.ids()[static_cast<std::size_t>(i)], x,
                                                        extent, 0.1 * store.radius(i), vessel.deepest);
    walls_.near.insert(walls_.near.end(), found.triangles.begin(), found.triangles.end());
    for (std::size_t k = 0; k < found.feature.size(); ++k) {
      walls_.particle.push_back(i);
      walls_.wall.push_back(static_cast<Wall>(static_cast<std::int32_t>(geometry::most_surfaces) + found.feature[k]));
      walls_.near_begin.push_back(before + found.end[k]);
    }
  }
}

}  // namespace packmpi::neighbor
