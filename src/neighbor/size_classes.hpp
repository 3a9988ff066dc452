/// Verlet pairs of particles of very different sizes: a grid of cells for each class of size.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "neighbor/lists.hpp"
#include "scene/cell_axis.hpp"
#include "scene/ownership.hpp"
#include "scene/scene.hpp"

namespace packmpi::neighbor {

/// Positions of all slots of a rank and their radii with margins [m], owned first; y or z empty where the scene has
/// none.
struct Cloud {
  std::span<const double> x, y, z, extent;
  LocalIndex owned = 0;
};

/// In columns and cells one largest interaction range wide, a small particle of a wide grading meets hundreds of
/// others. Here class k holds the extents of (r_max / 2^(k+1), r_max / 2^k] (the last one all smaller, too) in cells as
/// wide as they need. Each particle looks for its own class ahead of it and for all smaller classes around it; the
/// pairs are then counted into the order of a half list (Ogarko and Luding 2012 search the other way round). Cost and
/// memory: O(particles + pairs).
class SizeClasses {
 public:
  SizeClasses(const scene::Scene& scene, const scene::Ownership& ownership) : scene_(&scene), ownership_(&ownership) {}

  /// Local. The half list of PairList, pairs up to the sum of their extents. `list` is replaced.
  void build(const Cloud& cloud, PairList& list);
  /// Pairs looked at in the last build.
  [[nodiscard]] std::int64_t candidates() const noexcept { return candidates_; }

 private:
  // The particles of a class in the order of its cells, rows along the vertical.
  struct Level {
    double largest = 0.0;  // [m] extent of any here
    std::array<scene::CellAxis, 2> lateral;
    double bottom = 0.0, inverse_height = 0.0;
    int rows = 0;  // cells along the vertical
    std::vector<LocalIndex> start, slot;
    std::vector<double> x, y, z, extent;
  };
  struct Seeker {
    double x, y, z, extent;
    LocalIndex slot;
    bool own_class;
    std::size_t entry;  // its place, if own_class
  };
  void sort(const Cloud& cloud);
  void make_grid(Level& level, double low, double high) const;
  [[nodiscard]] std::size_t cell(const Level& level, double x, double y, double vertical) const noexcept;
  void look(const Seeker& seeker, const Level& level);
  void look_at(const Seeker& seeker, const Level& level, LocalIndex begin, LocalIndex end);
  void collect(PairList& list) const;

  const scene::Scene* scene_;
  const scene::Ownership* ownership_;
  std::vector<Level> levels_;
  LocalIndex owned_ = 0;
  struct Pair {
    LocalIndex first, second;
  };
  std::vector<Pair> pairs_;
  std::size_t found_ = 0;
  std::int64_t candidates_ = 0;
};

}  // namespace packmpi::neighbor
