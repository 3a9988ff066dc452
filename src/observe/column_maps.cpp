#include "observe/column_maps.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/volume.hpp"
#include "observe/column_field.hpp"

namespace packmpi::observe {
namespace {

constexpr double width_in_diameters = 4.0;
// On an empty plain columns are wider: their memory and their numbers in PETSc are bounded.
constexpr double most_columns = 0x1p20;

ColumnNumbering numbering(const scene::Scene& scene) {
  ColumnNumbering columns;
  double width = width_in_diameters * 2.0 * scene.sizes.mean();
  const int axes = scene.container.lateral_axes();
  const double wanted = scene.container.mean_area() / (axes == 2 ? width * width : width);
  if (wanted > most_columns) width *= axes == 2 ? std::sqrt(wanted / most_columns) : wanted / most_columns;
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.container.lateral_axes()); ++axis) {
    columns.lengths[axis] = scene.container.size[axis];
    columns.counts[axis] = std::max(std::int64_t{1}, static_cast<std::int64_t>(scene.container.size[axis] / width));
  }
  return columns;
}

/// Collective. Sums by column: terms become whole numbers of a quantum, a power of two that leaves their sum below
/// 2^52.
std::vector<double> sums(const comm::Comm& comm, const ColumnNumbering& columns, std::vector<ColumnValue> terms) {
  double largest = 0.0;
  for (const ColumnValue& term : terms) largest = std::max(largest, std::abs(term.value));
  const double bound = comm.max(largest) * static_cast<double>(comm.sum(std::ssize(terms)));
  int exponent = 0;
  (void)std::frexp(bound, &exponent);
  const double quantum = std::ldexp(1.0, exponent - 52);
  for (ColumnValue& term : terms) term.value = std::nearbyint(term.value / quantum);
  join_columns(terms, [](double a, double b) { return a + b; });
  ColumnField field(comm, columns);
  field.add(terms);
  std::vector<double> here = field.local();
  for (double& value : here) value *= quantum;
  return here;
}

std::vector<double> tops(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                         const ColumnNumbering& columns) {
  const particles::Store* one = &store;
  ColumnField field(comm, columns);
  field.raise_to(highest_tops(std::span(&one, 1), scene.container.vertical(), columns));
  return field.local();
}

std::vector<ColumnValue> volumes(const particles::Store& store, const scene::Scene& scene,
                                 const ColumnNumbering& columns) {
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  const double end = upper_end(scene.container);
  std::vector<ColumnValue> terms;
  terms.reserve(static_cast<std::size_t>(store.owned()));
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    const Vec3 x = store.position(i);
    terms.push_back(
        {columns.column(x), geometry::volume_below(scene.container.dimension, store.radius(i), x[vertical], end)});
  }
  return terms;
}

std::vector<ColumnValue> virials(const particles::Store& store, const scene::Scene& scene,
                                 const neighbor::PairList& pairs, const dynamics::StoredView& stored,
                                 const ColumnNumbering& columns) {
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  const double end = upper_end(scene.container);
  std::vector<ColumnValue> terms;
  each_contact(store, scene, pairs, stored, [&](const ContactForce& contact) {
    if (!(contact.middle[vertical] < end)) return;
    terms.push_back({columns.column(contact.middle), -contact.force[vertical] * contact.branch[vertical]});
  });
  return terms;
}

/// Volume [m3] of a column inside a round vessel up to H_d or a lid below it, from 32 x 32 points, or 16 x 16 at 16
/// heights if its walls are not straight (a point costs a search in a mesh): within a percent of a column; 0 if it is
/// less than an eighth of the column.
double volume_in(const geometry::Container& box, const ColumnMaps& maps, std::int64_t column) {
  const int side = box.straight() ? 32 : 16;
  const std::int64_t row = column / maps.counts[0];
  const auto ix = static_cast<double>(column % maps.counts[0]), iy = static_cast<double>(row);
  const int floors = box.straight() ? 1 : side, points = side * side * floors;
  const double end = upper_end(box);
  int inside = 0;
  for (int k = 0; k < points; ++k) {
    const int line = k / side % side, floor = k / (side * side);
    const double x = (ix + (k % side + 0.5) / side) * maps.widths[0];
    const double y = (iy + (line + 0.5) / side) * maps.widths[1];
    if (box.holds(box.at(x, y, (floor + 0.5) / floors * end), 0.0)) ++inside;
  }
  if (inside < points / 8) return 0.0;
  const double section = box.dimension == 3 ? maps.widths[0] * maps.widths[1] : maps.widths[0];
  return section * inside / points * end;
}

}  // namespace

std::int64_t map_columns(const scene::Scene& scene) { return numbering(scene).size(); }

ColumnMaps column_maps(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                       const neighbor::PairList& pairs, const dynamics::StoredView& stored) {
  const ColumnNumbering columns = numbering(scene);
  ColumnMaps maps{.counts = columns.counts,
                  .top = tops(comm, store, scene, columns),
                  .solid_fraction = sums(comm, columns, volumes(store, scene, columns)),
                  .vertical_stress = sums(comm, columns, virials(store, scene, pairs, stored, columns))};
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(scene.container.lateral_axes()); ++axis) {
    maps.widths[axis] = columns.lengths[axis] / static_cast<double>(columns.counts[axis]);
  }
  const geometry::Container& box = scene.container;
  if (!box.is_box()) {
    const std::int64_t first = comm.sum_below(std::ssize(maps.solid_fraction));
    for (std::size_t k = 0; k < maps.solid_fraction.size(); ++k) {  // of a sliver nothing can be said
      const double volume = volume_in(box, maps, first + static_cast<std::int64_t>(k));
      maps.solid_fraction[k] = volume > 0.0 ? maps.solid_fraction[k] / volume : 0.0;
      maps.vertical_stress[k] = volume > 0.0 ? maps.vertical_stress[k] / volume : 0.0;
    }
    return maps;
  }
  const double volume = box.volume_between(0.0, upper_end(box)) / static_cast<double>(columns.size());
  for (double& value : maps.solid_fraction) value /= volume;
  for (double& value : maps.vertical_stress) value /= volume;
  return maps;
}

}  // namespace packmpi::observe
