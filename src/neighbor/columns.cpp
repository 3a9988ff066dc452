#include <algorithm>
#include <map>

#include "neighbor/cells.hpp"

namespace packmpi::neighbor {

LocalColumns::LocalColumns(const scene::Ownership& ownership, Rank rank) : nx_(ownership.grid().counts()[0]) {
  number_own(ownership);
  own_ = static_cast<int>(global_.size());
  std::vector<geometry::ColumnIndex> touching;
  std::vector<std::vector<int>> forward(static_cast<std::size_t>(own_));
  around_start_.assign(1, 0);
  std::map<std::pair<Rank, int>, std::vector<geometry::ColumnIndex>> borders;
  for (int c = 0; c < own_; ++c) {
    ownership.grid().neighbors(global(c), touching);
    for (const geometry::ColumnIndex other : touching) {
      if (ownership.owner(other) != rank) borders[{ownership.owner(other), c}].push_back(other);
      int number = local(other);
      if (number < 0) {
        number = total();
        global_.push_back(other);
        ghost_lookup_.insert(std::ranges::lower_bound(ghost_lookup_, std::pair{other, 0}), {other, number});
      }
      if (number > c) forward[static_cast<std::size_t>(c)].push_back(number);
      around_.push_back(number);
    }
    around_start_.push_back(static_cast<int>(around_.size()));
  }
  forward_start_.assign(1, 0);
  for (std::vector<int>& list : forward) {
    std::ranges::sort(list);
    forward_.insert(forward_.end(), list.begin(), list.end());
    forward_start_.push_back(static_cast<int>(forward_.size()));
  }
  for (auto& [key, columns] : borders) borders_.push_back({key.second, key.first, std::move(columns)});
}

// Own columns sorted so that runs along the shorter extent are contiguous. Along the longer one every other part goes
// backwards, and a part that is a whole period goes both ways from its first row: rows that touch, here or across a
// border, then lie in the same half of the slots but near the middle (Halo).
void LocalColumns::number_own(const scene::Ownership& ownership) {
  const std::span<const geometry::ColumnIndex> own = ownership.columns();
  global_.assign(own.begin(), own.end());
  if (own.empty()) return;
  const auto x = [this](geometry::ColumnIndex c) { return static_cast<int>(c % nx_); };
  const auto y = [this](geometry::ColumnIndex c) { return static_cast<int>(c / nx_); };
  const auto [xl, xh] = std::ranges::minmax(global_, {}, x);
  const auto [yl, yh] = std::ranges::minmax(global_, {}, y);
  x0_ = x(xl), y0_ = y(yl);
  width_ = x(xh) - x0_ + 1;
  depth_ = y(yh) - y0_ + 1;
  const bool along_x = depth_ < width_;
  const std::size_t axis = along_x ? 0 : 1;
  const int rows = along_x ? width_ : depth_;
  const bool backwards = ownership.part()[axis] % 2 == 1;
  const bool ring = ownership.grid().box().periodic[axis] && rows == ownership.grid().counts()[axis];
  const auto rank_of_row = [&](int row) {
    if (ring) return std::min(2 * row, 2 * (rows - 1 - row) + 1);  // 0, the last, 1, the last but one, ...
    return backwards ? rows - 1 - row : row;
  };
  std::ranges::sort(global_, {}, [&](geometry::ColumnIndex c) {
    return std::pair{rank_of_row(along_x ? x(c) - x0_ : y(c) - y0_), along_x ? y(c) : x(c)};
  });
  own_lookup_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(depth_), -1);
  for (std::size_t k = 0; k < global_.size(); ++k) {
    own_lookup_[cell_of(x(global_[k]) - x0_, y(global_[k]) - y0_)] = static_cast<int>(k);
  }
}

int LocalColumns::local(geometry::ColumnIndex column) const noexcept {
  const int x = static_cast<int>(column % nx_) - x0_;
  const int y = static_cast<int>(column / nx_) - y0_;
  if (x >= 0 && x < width_ && y >= 0 && y < depth_) {
    const int found = own_lookup_[cell_of(x, y)];
    if (found >= 0) return found;
  }
  const auto at = std::ranges::lower_bound(ghost_lookup_, std::pair{column, 0});
  return at != ghost_lookup_.end() && at->first == column ? at->second : -1;
}

std::span<const int> LocalColumns::forward(int local) const noexcept {
  const auto c = static_cast<std::size_t>(local);
  return std::span(forward_).subspan(static_cast<std::size_t>(forward_start_[c]),
                                     static_cast<std::size_t>(forward_start_[c + 1] - forward_start_[c]));
}

std::span<const int> LocalColumns::around(int local) const noexcept {
  const auto c = static_cast<std::size_t>(local);
  return std::span(around_).subspan(static_cast<std::size_t>(around_start_[c]),
                                    static_cast<std::size_t>(around_start_[c + 1] - around_start_[c]));
}

}  // namespace packmpi::neighbor
