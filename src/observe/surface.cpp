/// The height of the surface: highest top of each lateral column, and their mean.
#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "comm/exact_sum.hpp"
#include "observe/column_field.hpp"
#include "observe/measure.hpp"

namespace packmpi::observe {
namespace {

/// The columns of the height test: their own grid, about one largest diameter wide.
ColumnNumbering make_columns(const scene::Scene& scene) {
  ColumnNumbering columns;
  const double width = 2.0 * scene.sizes.largest();
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.container.lateral_axes()); ++axis) {
    columns.lengths[axis] = scene.container.size[axis];
    columns.counts[axis] = std::max(std::int64_t{1}, static_cast<std::int64_t>(scene.container.size[axis] / width));
  }
  return columns;
}

constexpr int most_turns = 6;      // until a surface is found that is as high as its own area makes it
constexpr int samples_a_side = 8;  // of a column: points that tell how much of it is in a round vessel

/// At how many of the column's points centres can be that lie at a height [m]; all of them in a box.
std::int64_t places_of(const scene::Scene& scene, const ColumnNumbering& columns, std::int64_t column, double height) {
  const std::array<std::int64_t, 2> at{column % columns.counts[0], column / columns.counts[0]};
  std::int64_t places = 0;
  for (int k = 0; k < samples_a_side * samples_a_side; ++k) {
    const std::array<int, 2> point{k % samples_a_side, k / samples_a_side};
    std::array<double, 2> x{};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const double share = (point[axis] + 0.5) / samples_a_side;
      x[axis] =
          (static_cast<double>(at[axis]) + share) * columns.lengths[axis] / static_cast<double>(columns.counts[axis]);
    }
    if (scene.container.holds(scene.container.at(x[0], x[1], height), scene.sizes.mean())) ++places;
  }
  return places;
}

/// Collective. The same of all columns; each rank looks at its share of them.
std::int64_t places_of_all(const comm::Comm& comm, const scene::Scene& scene, const ColumnNumbering& columns,
                           double height) {
  std::int64_t places = 0;
  for (std::int64_t k = comm.rank(); k < columns.size(); k += comm.size())
    places += places_of(scene, columns, k, height);
  return comm.sum(places);
}

/// Collective. Columns are dealt out in runs; the tops of those of this rank's run that hold any particle of any rank.
std::vector<double> heights_by_mail(const comm::Comm& comm, const std::vector<ColumnValue>& tops,
                                    const ColumnNumbering& columns) {
  const std::int64_t run = columns.size() / comm.size() + 1;
  std::vector<comm::Parcel> parcels;
  for (const ColumnValue& top : tops) {  // ascending in rank, too
    const auto rank = static_cast<Rank>(top.column / run);
    if (parcels.empty() || parcels.back().rank != rank) parcels.push_back({rank, {}});
    const auto* bytes = reinterpret_cast<const std::byte*>(&top);
    parcels.back().bytes.insert(parcels.back().bytes.end(), bytes, bytes + sizeof top);
  }
  std::vector<ColumnValue> all;
  for (const comm::Parcel& parcel : comm::exchange(comm, std::move(parcels))) {
    const std::size_t before = all.size();
    all.resize(before + parcel.bytes.size() / sizeof(ColumnValue));
    std::memcpy(&all[before], parcel.bytes.data(), parcel.bytes.size());
  }
  keep_highest(all);
  std::vector<double> heights(all.size());
  std::ranges::transform(all, heights.begin(), &ColumnValue::value);
  return heights;
}

std::vector<double> heights_on_grid(const comm::Comm& comm, const std::vector<ColumnValue>& tops,
                                    const ColumnNumbering& columns) {
  ColumnField heights(comm, columns);
  heights.raise_to(tops);
  return heights.local();
}

}  // namespace

double surface_height(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                      std::int64_t most_stored) {
  const particles::Store* one = &store;
  return surface_height(comm, std::span(&one, 1), scene, most_stored);
}

double surface_height(const comm::Comm& comm, std::span<const particles::Store* const> stores,
                      const scene::Scene& scene, std::int64_t most_stored) {
  const ColumnNumbering columns = make_columns(scene);
  const std::vector<ColumnValue> tops = highest_tops(stores, scene.container.vertical(), columns);
  const bool few = columns.size() <= most_stored;
  const auto sum = [&](const std::vector<ColumnValue>& terms) {
    return comm::exact_sum(comm, few ? heights_on_grid(comm, terms, columns) : heights_by_mail(comm, terms, columns));
  };
  if (scene.container.is_box()) return sum(tops) / static_cast<double>(columns.size());
  // The mean over the vessel: a column counts as much as it has room for centres, at the surface that is looked for.
  double surface = 0.0;
  for (const ColumnValue& top : tops) surface = std::max(surface, top.value);
  surface = comm.max(surface);
  const int turns = scene.container.straight() ? 1 : most_turns;
  for (int turn = 0; turn < turns; ++turn) {
    const double level = surface - scene.sizes.mean();
    std::vector<ColumnValue> weighted = tops;
    for (ColumnValue& top : weighted) top.value *= static_cast<double>(places_of(scene, columns, top.column, level));
    const auto all = static_cast<double>(std::max<std::int64_t>(1, places_of_all(comm, scene, columns, level)));
    const double next = sum(weighted) / all;
    if (next == surface) break;  // nothing would change any more
    surface = next;
  }
  return surface;
}

}  // namespace packmpi::observe
