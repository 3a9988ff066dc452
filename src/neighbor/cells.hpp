/// Columns cut into cells of one interaction range, and the particles in their order: the memory order of a rank.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "particles/store.hpp"
#include "scene/ownership.hpp"

namespace packmpi::neighbor {

/// The columns of a rank with their surroundings. Made anew when the ownership changes. Local columns are numbered: own
/// columns first, rows along the shorter extent fastest (that keeps the window of the half list small), in every other
/// part from high to low along the longer one, and in a whole period from both ends in turn; then the ghost columns.
class LocalColumns {
 public:
  explicit LocalColumns(const scene::Ownership& ownership, Rank rank);

  [[nodiscard]] int own() const noexcept { return own_; }
  [[nodiscard]] int total() const noexcept { return static_cast<int>(global_.size()); }
  /// Local number of a global column; -1 if it is neither ours nor touching ours.
  [[nodiscard]] int local(geometry::ColumnIndex column) const noexcept;
  [[nodiscard]] geometry::ColumnIndex global(int local) const noexcept {
    return global_[static_cast<std::size_t>(local)];
  }
  /// Columns touching own column `local` that a half list must visit: own ones with a higher number, and all ghost
  /// columns.
  [[nodiscard]] std::span<const int> forward(int local) const noexcept;
  /// All columns touching own column `local`, own and ghost, without itself.
  [[nodiscard]] std::span<const int> around(int local) const noexcept;

  /// A rank that needs particles of own column `local`, and the columns of its that touch it.
  struct Border {
    int local;
    Rank rank;
    std::vector<geometry::ColumnIndex> columns;
  };
  /// All borders, ascending in (rank, local).
  [[nodiscard]] const std::vector<Border>& borders() const noexcept { return borders_; }

 private:
  void number_own(const scene::Ownership& ownership);
  /// Place of a column in own_lookup_, by its coordinates in the bounding rectangle.
  [[nodiscard]] std::size_t cell_of(int x, int y) const noexcept {
    return static_cast<std::size_t>(x) + static_cast<std::size_t>(width_) * static_cast<std::size_t>(y);
  }
  int own_ = 0;
  std::vector<geometry::ColumnIndex> global_;
  std::vector<std::pair<geometry::ColumnIndex, int>> ghost_lookup_;  // sorted
  std::vector<int> own_lookup_;  // dense over the bounding rectangle of the own columns; -1 elsewhere
  int x0_ = 0, y0_ = 0, width_ = 0, depth_ = 0, nx_ = 1;
  std::vector<int> forward_start_, forward_;
  std::vector<int> around_start_, around_;
  std::vector<Border> borders_;
};

/// Slots of the particles in each cell: cell (column c, level k) holds slots start[c * levels + k] .. start[c * levels
/// + k + 1).
struct Cells {
  int levels = 1;
  double bottom = 0.0;            ///< [m] of the lowest level; what lies below it is in that level too
  double inverse_height = 0.0;    ///< [1/m] of a cell
  std::vector<LocalIndex> start;  ///< total columns * levels + 1

  [[nodiscard]] int level(double vertical) const noexcept {
    const double k = (vertical - bottom) * inverse_height;
    return k >= static_cast<double>(levels) ? levels - 1 : (k > 0.0 ? static_cast<int>(k) : 0);
  }
};

}  // namespace packmpi::neighbor
