/// A cell grid over this rank's part of a layer, and bins of spheres on it: "which of these spheres does that one
/// overlap?"
#pragma once
#include <array>
#include <cassert>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/columns.hpp"
#include "rsa/insert.hpp"
#include "rsa/sphere.hpp"

namespace packmpi::rsa {

/// The cells this rank needs along one axis: `count` of the `total` cells of the box, from cell `first`, in slots 1 ..
/// count. Slots 0 and count + 1 stay empty, so that stepping off the edge needs no test.
struct CellAxis {
  double origin = 0.0;   ///< [m]
  double inverse = 0.0;  ///< 1 / cell width [1/m]
  int total = 1;
  int first = 0;
  int count = 1;
  bool closed = false;  ///< periodic, and all cells are here: the last is next to the first

  [[nodiscard]] int slot(double x) const noexcept {
    int cell = static_cast<int>((x - origin) * inverse);
    cell = (cell < 0 ? 0 : cell >= total ? total - 1 : cell) - first;
    if (cell < 0) cell += total;
    assert(cell < count);
    return cell + 1;
  }
  [[nodiscard]] int below(int slot) const noexcept { return closed && slot == 1 ? count : slot - 1; }
  [[nodiscard]] int above(int slot) const noexcept { return closed && slot == count ? 1 : slot + 1; }
};

/// The cells of a layer that can hold a sphere of this rank's columns or one that overlaps it. Cells are at least as
/// wide as the largest diameter: the spheres that overlap one are in its cell or one of the cells around it. Local;
/// O(columns).
class CellGrid {
 public:
  /// `asked` particles in the whole layer; cells are kept to a few a particle.
  CellGrid(const scene::Scene& scene, const scene::Ownership& ownership, const LayerRegion& region, std::int64_t asked);

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
  std::array<CellAxis, 2> axes_;
  CellAxis vertical_axis_;
};

/// Spheres in the cells of a grid, as chains. Only grows, or is cleared.
class Bins {
 public:
  Bins(const CellGrid& grid, const Metric& metric) : grid_(&grid), metric_(metric), heads_(grid.size(), none) {}

  /// Add a sphere under a number of the caller's.
  void add(const Sphere& sphere, std::int32_t tag) {
    std::int32_t& head = heads_[grid_->cell(sphere.centre)];
    nodes_.push_back({sphere, head, tag});
    head = static_cast<std::int32_t>(nodes_.size()) - 1;
  }
  void clear() {  // touches only the cells in use
    for (const Node& node : nodes_) heads_[grid_->cell(node.sphere.centre)] = none;
    nodes_.clear();
  }
  [[nodiscard]] bool empty() const noexcept { return nodes_.empty(); }
  void reserve(std::size_t count) { nodes_.reserve(count); }

  /// True if `counts(tag)` for any sphere here that overlaps this one.
  template <class Counts>
  [[nodiscard]] bool any(const Sphere& sphere, Counts&& counts) const {
    const CellGrid::Rows rows = grid_->rows(sphere.centre);
    for (const std::size_t row : std::span(rows).first(grid_->row_count())) {
      for (std::size_t cell = row; cell < row + 3; ++cell) {
        for (std::int32_t k = heads_[cell]; k != none; k = nodes_[static_cast<std::size_t>(k)].next) {
          const Node& node = nodes_[static_cast<std::size_t>(k)];
          if (metric_.overlap(sphere, node.sphere) && counts(node.tag)) return true;
        }
      }
    }
    return false;
  }
  [[nodiscard]] bool overlaps(const Sphere& sphere) const {
    return any(sphere, [](std::int32_t) { return true; });
  }

 private:
  static constexpr std::int32_t none = -1;
  struct Node {
    Sphere sphere;
    std::int32_t next;
    std::int32_t tag;
  };
  const CellGrid* grid_;
  Metric metric_;
  std::vector<std::int32_t> heads_;
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
