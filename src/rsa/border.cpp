#include "rsa/border.hpp"

#include <algorithm>

namespace packmpi::rsa {

Border::Border(const scene::Ownership& ownership, Rank mine, double largest)
    : grid_(&ownership.grid()), largest_(largest) {
  if (ownership.neighbors().empty()) return;
  std::vector<geometry::ColumnIndex> around;
  for (const geometry::ColumnIndex column : ownership.columns()) {
    grid_->neighbors(column, around);
    for (const geometry::ColumnIndex other : around) {
      const Rank owner = ownership.owner(other);
      if (owner != mine) touches_.push_back({column, owner, other});
    }
  }
  std::ranges::sort(touches_);
}

void Border::ranks(const Sphere& sphere, std::vector<Rank>& out) const {
  out.clear();
  if (touches_.empty()) return;
  const double reach = (sphere.radius + largest_) * (1.0 + slack);
  const geometry::ColumnIndex column = grid_->column(sphere.centre);
  for (auto touch = std::ranges::lower_bound(touches_, column, {}, &Touch::mine);
       touch != touches_.end() && touch->mine == column; ++touch) {
    if (!out.empty() && out.back() == touch->owner) continue;
    if (grid_->distance(sphere.centre, touch->other) <= reach) out.push_back(touch->owner);
  }
}

}  // namespace packmpi::rsa
