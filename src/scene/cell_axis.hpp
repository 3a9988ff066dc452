/// One axis of a cell grid over a rank's part of the box.
#pragma once
#include <cassert>
#include <cstddef>

#include "scene/ownership.hpp"

namespace packmpi::scene {

/// The cells a rank needs along one axis: `count` of the `total` cells of the box, from cell `first`, in slots 1 ..
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

/// Cells at least `width` wide (or one) under the run of this rank's columns along a lateral axis, and `margin` further
/// on both sides. [m] Local; O(columns).
[[nodiscard]] CellAxis lateral_axis(const Ownership& ownership, std::size_t axis, double width, double margin);

}  // namespace packmpi::scene
