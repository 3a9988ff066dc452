/// What a pair of particles reads from their records, gives to their sums and stores from step to step: the table that
/// a law's author edits. The kernel's gather and scatter, the memory of the contacts, its way through rebuilds,
/// migration and checkpoints follow from it; the record itself is particles::Layout.
#pragma once
#include <array>
#include <string_view>

#include "scene/features.hpp"

namespace packmpi::scene {

/// How the values of the two ends are combined. A wall is a second end at rest: zeros.
enum class Combine { sum, difference };  ///< second + first, second - first

/// What the other end of a pair has of the same quantity.
enum class Mirror {
  same,
  opposite,
  own  ///< a number of its own, which exchanging the ends exchanges
};

/// `components` neighbouring doubles of the record, from `offset` on.
struct Reading {
  int offset, components;
  Combine combine;
};

/// `components` neighbouring sums of a particle (see dynamics::accumulators_of), from `accumulator` on.
struct Giving {
  int accumulator, components;
  Mirror mirror;
};

/// A vector kept for each contact, zero where two do not touch. Oriented from the first end to the second.
struct Storing {
  std::string_view name, unit;
  int components;
  Mirror mirror;  ///< same or opposite
};

/// Up to `Most` rows of a table.
template <class Row, int Most>
struct Rows {
  std::array<Row, static_cast<std::size_t>(Most)> rows{};
  int count = 0;

  constexpr void add(const Row& row) { rows[static_cast<std::size_t>(count++)] = row; }
  [[nodiscard]] constexpr const Row* begin() const { return rows.data(); }
  [[nodiscard]] constexpr const Row* end() const { return rows.data() + count; }
};

/// What the law of these features reads. A field that is read twice is combined in both ways.
[[nodiscard]] constexpr Rows<Reading, 9> readings(const Features& f) {
  const particles::Layout layout = f.layout();
  Rows<Reading, 9> table;
  table.add({layout.position, layout.dimension, Combine::difference});
  table.add({layout.radius, 1, Combine::sum});
  table.add({layout.velocity, layout.dimension, Combine::difference});
  table.add({layout.curvature, 1, Combine::sum});
  if (f.rotation) table.add({layout.spin, layout.spin_components(), Combine::sum});  // slip at the point of contact
  if (f.rolling) table.add({layout.spin, layout.spin_components(), Combine::difference});
  if (f.rolling && f.graded) table.add({layout.curvature, 1, Combine::difference});
  if (f.mixture) table.add({layout.component, 2, Combine::sum});  // the pair's code, and 1/m*
  return table;
}

/// What it gives: a force, and the moment over the radius n x f_t, to which rolling adds its own at each end.
[[nodiscard]] constexpr Rows<Giving, 2> givings(const Features& f) {
  Rows<Giving, 2> table;
  table.add({0, f.dimension, Mirror::opposite});
  if (f.rotation) {
    table.add({f.dimension == 3 ? 4 : 2, f.dimension == 3 ? 3 : 1, f.rolling ? Mirror::own : Mirror::same});
  }
  return table;
}

/// What it stores. In the plane the tangent (-n_y, n_x) turns with the pair, so that slip is a number along it.
[[nodiscard]] constexpr Rows<Storing, 3> storings(const Features& f) {
  const bool deep = f.dimension == 3;
  Rows<Storing, 3> table;
  if (f.memory) table.add({"tangential_displacement", "m", deep ? 3 : 1, deep ? Mirror::opposite : Mirror::same});
  if (f.rolling) table.add({"rolling_displacement", "m", deep ? 3 : 1, Mirror::opposite});
  if (f.rolling && deep) table.add({"twisting_displacement", "m", 1, Mirror::same});
  return table;
}

/// Doubles stored for each contact.
[[nodiscard]] constexpr int stored_doubles(const Features& f) {
  int sum = 0;
  for (const Storing& row : storings(f)) sum += row.components;
  return sum;
}
inline constexpr int most_stored_doubles = stored_doubles({.memory = true, .rolling = true});

/// 1 or -1: the factor of each stored double when the ends of a pair are exchanged.
[[nodiscard]] constexpr std::array<double, most_stored_doubles> stored_signs(const Features& f) {
  std::array<double, most_stored_doubles> signs{};
  std::size_t at = 0;
  for (const Storing& row : storings(f)) {
    for (int c = 0; c < row.components; ++c) signs[at++] = row.mirror == Mirror::opposite ? -1.0 : 1.0;
  }
  return signs;
}

}  // namespace packmpi::scene
