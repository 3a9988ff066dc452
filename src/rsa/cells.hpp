/// A cell grid over this rank's part of a layer, and bins of spheres on it: "which of these spheres does that one
/// overlap?"
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "rsa/insert.hpp"
#include "rsa/sphere.hpp"
#include "scene/cell_axis.hpp"

namespace packmpi::rsa {

/// The cells of a layer that can hold a sphere of this rank's columns or one that overlaps it. Cells are at least
/// `diameter` wide, a gap included: the spheres not wider than that which overlap one not wider either are in its cell
/// or one of the cells around it. Local; O(columns).
class CellGrid {
 public:
  /// `asked` particles in the whole layer; cells are kept to a few a particle.
  CellGrid(const scene::Scene& scene, const scene::Ownership& ownership, const LayerRegion& region, std::int64_t asked,
           double diameter);

  using Rows = std::array<std::size_t, 9>;  ///< first cells of rows of three along the vertical
  /// The rows around a position, its own first. All nine in 3D, the first three in 2D.
  [[nodiscard]] Rows rows(const Vec3& position) const noexcept;
  [[nodiscard]] std::size_t row_count() const noexcept { return lateral_ == 2 ? 9 : 3; }
  [[nodiscard]] std::size_t cell(const Vec3& position) const noexcept;
  [[nodiscard]] std::size_t size() const noexcept { return row_length() * plane_length() * lines(); }

 private:
  [[nodiscard]] std::size_t row_length() const noexcept { return static_cast<std::size_t>(vertical_axis_.count) + 2; }
  [[nodiscard]] std::size_t plane_length() const noexcept { return static_cast<std::size_t>(axes_[0].count) + 2; }
  [[nodiscard]] std::size_t lines() const noexcept { return static_cast<std::size_t>(axes_[1].count) + 2; }
  [[nodiscard]] std::size_t index(int sx, int sy, int sz) const noexcept {
    return (static_cast<std::size_t>(sy) * plane_length() + static_cast<std::size_t>(sx)) * row_length() +
           static_cast<std::size_t>(sz);
  }

  int lateral_ = 2;
  std::array<scene::CellAxis, 2> axes_;
  scene::CellAxis vertical_axis_;
};

/// Grids for levels of size, so that small spheres need not search among those in large cells: one grid if radii are
/// alike, else one for each two size classes. A sphere is searched for in its own level and those of larger spheres
/// only, which is enough as large ones are placed first.
class CellGrids {
 public:
  CellGrids(const scene::Scene& scene, const scene::Ownership& ownership, const LayerRegion& region,
            std::int64_t asked);

  [[nodiscard]] std::size_t levels() const noexcept { return grids_.size(); }
  [[nodiscard]] const CellGrid& grid(std::size_t level) const noexcept { return grids_[level]; }
  [[nodiscard]] std::size_t level(double radius) const noexcept {
    std::size_t k = 0;
    while (k + 1 < grids_.size() && radius <= largest_[k + 1]) ++k;
    return k;
  }

 private:
  std::vector<double> largest_;  // [m] radius in each level
  std::vector<CellGrid> grids_;
};

/// Spheres in the cells of their level's grid, as chains. Only grows, or is cleared.
class Bins {
 public:
  Bins(const CellGrids& grids, const Metric& metric) : grids_(&grids), metric_(metric), used_(grids.levels(), 0) {
    for (std::size_t k = 0; k < grids.levels(); ++k) heads_.emplace_back(grids.grid(k).size(), none);
  }

  /// Add a sphere under a number of the caller's.
  void add(const Sphere& sphere, std::int32_t tag) {
    const std::size_t level = grids_->level(sphere.radius);
    std::int32_t& head = heads_[level][grids_->grid(level).cell(sphere.centre)];
    nodes_.push_back({sphere, head, tag});
    head = static_cast<std::int32_t>(nodes_.size()) - 1;
    used_[level] = 1;
  }
  void clear() {  // touches only the cells in use
    for (const Node& node : nodes_) {
      const std::size_t level = grids_->level(node.sphere.radius);
      heads_[level][grids_->grid(level).cell(node.sphere.centre)] = none;
    }
    nodes_.clear();
    used_.assign(used_.size(), 0);
  }
  [[nodiscard]] bool empty() const noexcept { return nodes_.empty(); }
  void reserve(std::size_t count) { nodes_.reserve(count); }

  /// True if `counts(tag)` for any sphere here that overlaps this one. All here are of its level or larger ones'.
  template <class Counts>
  [[nodiscard]] bool any(const Sphere& sphere, Counts&& counts) const {
    for (std::size_t level = 0; level <= grids_->level(sphere.radius); ++level) {
      if (used_[level] != 0 && any_in(level, sphere, counts)) return true;
    }
    return false;
  }
  [[nodiscard]] bool overlaps(const Sphere& sphere) const {
    return any(sphere, [](std::int32_t) { return true; });
  }

  /// Fetches what any() of this sphere will ask for: the cells, and once they are there the first sphere of each.
  void fetch_cells(const Sphere& sphere) const noexcept {
    in_rows(sphere, [](const std::int32_t* row) { __builtin_prefetch(row); });
  }
  void fetch_spheres(const Sphere& sphere) const noexcept {
    in_rows(sphere, [&](const std::int32_t* row) {
      for (const std::int32_t head : std::span(row, 3)) {
        if (head != none) __builtin_prefetch(&nodes_[static_cast<std::size_t>(head)]);
      }
    });
  }

 private:
  template <class Row>
  void in_rows(const Sphere& sphere, Row&& row) const noexcept {
    for (std::size_t level = 0; level <= grids_->level(sphere.radius); ++level) {
      if (used_[level] == 0) continue;
      const CellGrid& grid = grids_->grid(level);
      const CellGrid::Rows rows = grid.rows(sphere.centre);
      for (const std::size_t first : std::span(rows).first(grid.row_count())) row(heads_[level].data() + first);
    }
  }
  template <class Counts>
  [[nodiscard]] bool any_in(std::size_t level, const Sphere& sphere, Counts&& counts) const {
    const CellGrid& grid = grids_->grid(level);
    const std::vector<std::int32_t>& heads = heads_[level];
    const CellGrid::Rows rows = grid.rows(sphere.centre);
    for (const std::size_t row : std::span(rows).first(grid.row_count())) {
      for (std::size_t cell = row; cell < row + 3; ++cell) {
        for (std::int32_t k = heads[cell]; k != none; k = nodes_[static_cast<std::size_t>(k)].next) {
          const Node& node = nodes_[static_cast<std::size_t>(k)];
          if (metric_.overlap(sphere, node.sphere) && counts(node.tag)) return true;
        }
      }
    }
    return false;
  }

  static constexpr std::int32_t none = -1;
  struct Node {
    Sphere sphere;
    std::int32_t next;
    std::int32_t tag;
  };
  const CellGrids* grids_;
  Metric metric_;
  std::vector<std::vector<std::int32_t>> heads_;  // of each level
  std::vector<char> used_;                        // levels with spheres
  std::vector<Node> nodes_;
};

inline std::size_t CellGrid::cell(const Vec3& position) const noexcept {
  const int sy = lateral_ == 2 ? axes_[1].slot(position[1]) : 1;
  return index(axes_[0].slot(position[0]), sy, vertical_axis_.slot(position[lateral_ == 2 ? 2 : 1]));
}

inline CellGrid::Rows CellGrid::rows(const Vec3& position) const noexcept {
  const int sx = axes_[0].slot(position[0]);
  const int sy = lateral_ == 2 ? axes_[1].slot(position[1]) : 1;
  const int sz = vertical_axis_.slot(position[lateral_ == 2 ? 2 : 1]) - 1;
  const int left = axes_[0].below(sx);
  const int right = axes_[0].above(sx);
  const int front = axes_[1].below(sy);
  const int back = axes_[1].above(sy);
  return {index(sx, sy, sz),       index(left, sy, sz),   index(right, sy, sz),
          index(sx, front, sz),    index(sx, back, sz),   index(left, front, sz),
          index(right, front, sz), index(left, back, sz), index(right, back, sz)};
}

}  // namespace packmpi::rsa
