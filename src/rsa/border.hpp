/// Which other ranks must know of a sphere on this one.
#pragma once
#include <compare>
#include <vector>

#include "rsa/sphere.hpp"
#include "scene/ownership.hpp"

namespace packmpi::rsa {

/// The columns of this rank that touch columns of others. Memory: O(border columns). Local.
class Border {
 public:
  /// `largest` is the largest radius, and a gap that spheres keep [m].
  Border(const scene::Ownership& ownership, Rank mine, double largest);

  /// The ranks that own a column which a sphere overlapping this one may have its centre in; each once, ascending. The
  /// sphere lies in a column of ours. `out` is replaced.
  void ranks(const Sphere& sphere, std::vector<Rank>& out) const;

 private:
  struct Touch {
    geometry::ColumnIndex mine;
    Rank owner;
    geometry::ColumnIndex other;
    friend auto operator<=>(const Touch&, const Touch&) = default;
  };
  const geometry::ColumnGrid* grid_;
  double largest_;
  std::vector<Touch> touches_;  // ascending
};

}  // namespace packmpi::rsa
