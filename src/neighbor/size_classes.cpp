#include "neighbor/size_classes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace packmpi::neighbor {
namespace {

// Cells are kept to about so many a particle, whatever the extents.
constexpr double cells_a_particle = 8.0;

// Slots of an axis that may hold what is within `reach` of x, each once; `out` has room for axis.count. Their number.
int slots_near(const scene::CellAxis& axis, bool periodic, double x, double reach, std::vector<int>& out) {
  out.clear();
  auto low = static_cast<int>(std::floor((x - reach - axis.origin) * axis.inverse));
  auto high = static_cast<int>(std::floor((x + reach - axis.origin) * axis.inverse));
  if (!periodic) {
    low = std::clamp(low, 0, axis.total - 1);
    high = std::clamp(high, 0, axis.total - 1);
  } else if (high - low + 1 >= axis.total) {
    low = 0;
    high = axis.total - 1;
  }
  for (int k = low; k <= high; ++k) {
    int here = (k % axis.total + axis.total) % axis.total - axis.first;
    if (here < 0) here += axis.total;
    if (here < axis.count) out.push_back(here + 1);
  }
  return static_cast<int>(out.size());
}

}  // namespace

void SizeClasses::build(const Cloud& cloud, PairList& list) {
  owned_ = cloud.owned;
  found_ = 0;
  candidates_ = 0;
  sort(cloud);
  for (std::size_t k = 0; k < levels_.size(); ++k) {
    const Level& mine = levels_[k];
    for (std::size_t e = 0; e < mine.slot.size(); ++e) {
      const Seeker seeker{mine.x[e], mine.y[e], mine.z[e], mine.extent[e], mine.slot[e], true, e};
      look(seeker, mine);
      Seeker stranger = seeker;
      stranger.own_class = false;
      for (std::size_t l = k + 1; l < levels_.size(); ++l) look(stranger, levels_[l]);
    }
  }
  collect(list);
}

// Cells one interaction range of the class wide; wider where that would make many more cells than particles.
void SizeClasses::make_grid(Level& level, double low, double high) const {
  const geometry::Container& box = scene_->container;
  const double width = 2.0 * level.largest * (1.0 + 1e-9);
  const double margin = scene_->list_range() * (1.0 + 1e-9);
  const double most = cells_a_particle * static_cast<double>(level.slot.size()) + 4096.0;
  const auto lateral_cells = [&](double wide) {
    double cells = 1.0;
    for (std::size_t a = 0; a < static_cast<std::size_t>(box.lateral_axes()); ++a) {
      const double least = box.periodic[a] ? box.size[a] / 3.0 : box.size[a];  // an image is met once
      level.lateral[a] = scene::lateral_axis(*ownership_, a, std::max(width, std::min(wide, least)), margin);
      cells *= level.lateral[a].count + 2;
    }
    return cells;
  };
  double lateral = lateral_cells(width);
  if (lateral > most)
    lateral = lateral_cells(width * (box.dimension == 3 ? std::sqrt(lateral / most) : lateral / most));
  const double rows = std::clamp((high - low) / width, 1.0, std::max(1.0, most / lateral));
  level.bottom = low;
  level.rows = static_cast<int>(rows);
  level.inverse_height = level.rows / std::max(high - low, width);
  const std::size_t lines = box.lateral_axes() == 2 ? static_cast<std::size_t>(level.lateral[1].count) + 2 : 1;
  level.start.assign(
      (static_cast<std::size_t>(level.lateral[0].count) + 2) * lines * static_cast<std::size_t>(level.rows) + 1, 0);
}

std::size_t SizeClasses::cell(const Level& level, double x, double y, double vertical) const noexcept {
  const int sx = level.lateral[0].slot(x);
  const int sy = scene_->container.lateral_axes() == 2 ? level.lateral[1].slot(y) : 0;
  const int row = std::clamp(static_cast<int>((vertical - level.bottom) * level.inverse_height), 0, level.rows - 1);
  const auto plane = static_cast<std::size_t>(level.lateral[0].count) + 2;
  return (static_cast<std::size_t>(sy) * plane + static_cast<std::size_t>(sx)) * static_cast<std::size_t>(level.rows) +
         static_cast<std::size_t>(row);
}

void SizeClasses::sort(const Cloud& cloud) {
  const bool deep = scene_->container.dimension == 3;
  const auto up = [&](std::size_t i) { return deep ? cloud.z[i] : cloud.y[i]; };
  const auto count = static_cast<std::size_t>(scene_->features.size_levels);
  levels_.resize(count);
  for (Level& level : levels_) level.slot.clear(), level.largest = 0.0;
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
  for (std::size_t i = 0; i < cloud.x.size(); ++i) {
    std::size_t k = 0;
    for (double half = 0.5 * scene_->sizes.largest(); k + 1 < count && cloud.extent[i] <= half; half *= 0.5) ++k;
    levels_[k].slot.push_back(static_cast<LocalIndex>(i));
    levels_[k].largest = std::max(levels_[k].largest, cloud.extent[i]);
    low = std::min(low, up(i));
    high = std::max(high, up(i));
  }
  std::vector<std::size_t> home;
  for (Level& level : levels_) {
    const std::vector<LocalIndex> unsorted = level.slot;
    const std::size_t n = unsorted.size();
    for (auto* field : {&level.x, &level.y, &level.z, &level.extent}) field->resize(n);
    if (n == 0) continue;
    make_grid(level, low, high);
    home.resize(n);
    for (std::size_t e = 0; e < n; ++e) {
      const auto i = static_cast<std::size_t>(unsorted[e]);
      home[e] = cell(level, cloud.x[i], cloud.y[i], up(i));
      ++level.start[home[e] + 1];
    }
    std::partial_sum(level.start.begin(), level.start.end(), level.start.begin());
    std::vector<LocalIndex> next(level.start.begin(), level.start.end() - 1);
    for (std::size_t e = 0; e < n; ++e) {
      const auto to = static_cast<std::size_t>(next[home[e]]++);
      const auto i = static_cast<std::size_t>(unsorted[e]);
      level.slot[to] = unsorted[e];
      level.x[to] = cloud.x[i];
      level.y[to] = cloud.y[i];
      level.z[to] = deep ? cloud.z[i] : 0.0;
      level.extent[to] = cloud.extent[i];
    }
  }
}

// All of the class that the seeker may touch; of its own class those behind it in the order of cells.
void SizeClasses::look(const Seeker& seeker, const Level& level) {
  if (level.slot.empty()) return;
  const geometry::Container& box = scene_->container;
  const double reach = (seeker.extent + level.largest) * (1.0 + 1e-9);
  const bool plane = box.lateral_axes() == 2;
  thread_local std::vector<int> xs, ys;
  slots_near(level.lateral[0], box.periodic[0], seeker.x, reach, xs);
  if (plane) {
    slots_near(level.lateral[1], box.periodic[1], seeker.y, reach, ys);
  } else {
    ys.assign(1, 0);
  }
  const double vertical = plane ? seeker.z : seeker.y;
  const auto row = [&](double z) {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>((z - level.bottom) * level.inverse_height), 0, level.rows - 1));
  };
  const std::size_t low = row(vertical - reach);
  const std::size_t high = row(vertical + reach);
  const auto width = static_cast<std::size_t>(level.lateral[0].count) + 2;
  const auto ahead = static_cast<LocalIndex>(seeker.own_class ? seeker.entry + 1 : 0);
  for (const int sy : ys) {
    for (const int sx : xs) {
      const std::size_t line =
          (static_cast<std::size_t>(sy) * width + static_cast<std::size_t>(sx)) * static_cast<std::size_t>(level.rows);
      look_at(seeker, level, std::max(ahead, level.start[line + low]), level.start[line + high + 1]);
    }
  }
}

void SizeClasses::look_at(const Seeker& seeker, const Level& level, LocalIndex begin, LocalIndex end) {
  if (begin >= end) return;
  const auto n = static_cast<std::size_t>(end - begin);
  candidates_ += static_cast<std::int64_t>(n);
  if (pairs_.size() < found_ + n) pairs_.resize(std::max(2 * pairs_.size(), found_ + n + 4096));
  const geometry::Container& box = scene_->container;
  const double base = seeker.extent;
  const bool periodic = scene_->features.periodic;
  Pair* out = pairs_.data() + found_;
  for (auto e = static_cast<std::size_t>(begin); e < static_cast<std::size_t>(end); ++e) {
    double dx = level.x[e] - seeker.x;
    double dy = level.y[e] - seeker.y;
    if (periodic) {
      if (box.periodic[0]) dx = geometry::shortest(dx, box.size[0]);
      if (box.dimension == 3 && box.periodic[1]) dy = geometry::shortest(dy, box.size[1]);
    }
    const double dz = level.z[e] - seeker.z;
    const double cut = base + level.extent[e];
    const LocalIndex other = level.slot[e];
    *out = {std::min(seeker.slot, other), std::max(seeker.slot, other)};
    out += static_cast<int>((dx * dx + dy * dy + dz * dz < cut * cut) & (out->first < owned_));
  }
  found_ = static_cast<std::size_t>(out - pairs_.data());
}

// Into the order of the first.
void SizeClasses::collect(PairList& list) const {
  std::vector<LocalIndex> end(static_cast<std::size_t>(owned_) + 1, 0);
  const std::span<const Pair> pairs(pairs_.data(), found_);
  for (const Pair& pair : pairs) ++end[static_cast<std::size_t>(pair.first) + 1];
  std::partial_sum(end.begin(), end.end(), end.begin());
  list.first.resize(found_);
  list.second.resize(found_);
  list.window = 1;
  for (const Pair& pair : pairs) {
    const auto at = static_cast<std::size_t>(end[static_cast<std::size_t>(pair.first)]++);
    list.first[at] = pair.first;
    list.second[at] = pair.second;
    if (pair.second < owned_) list.window = std::max(list.window, pair.second - pair.first + 1);
  }
}

}  // namespace packmpi::neighbor
