/// An interior inside a closed surface of triangles: volumes, sections, distances.
#pragma once
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "mesh/features.hpp"
#include "mesh/grid.hpp"
#include "mesh/shell.hpp"

namespace packmpi::mesh {

/// What is nearest to a point.
struct Nearest {
  double distance;  ///< [m], negative outside the interior
  Vec3 place;       ///< [m] of the surface
};

/// Features of a surface that a sphere may touch, by their numbers in ascending order; of each the triangles that it
/// may be above.
struct NearFeatures {
  std::vector<std::int32_t> feature, end;  ///< end of its triangles; those of the first begin at 0
  std::vector<std::int32_t> triangles;
  struct Hit {
    std::int32_t triangle;
    double squared;  // [m2] to its middle
  };
  std::vector<Hit> hits;            // of the search
  std::vector<std::uint32_t> seen;  // of each triangle: the last search that has looked at it
  std::uint32_t search = 0;

  [[nodiscard]] std::int32_t begin(std::size_t k) const { return k == 0 ? 0 : end[k - 1]; }
  void clear() { feature.clear(), end.clear(), triangles.clear(); }
};

/// Immutable. The same on every rank. Local; every function may be called by several threads at once.
class Surface {
 public:
  /// Throws as close(). Cost: O(triangles).
  Surface(const std::vector<Corners>& triangles, const std::string& name);

  [[nodiscard]] const Shell& shell() const { return shell_; }
  [[nodiscard]] const Vec3& low() const { return shell_.low; }    ///< [m] of the box around it
  [[nodiscard]] const Vec3& high() const { return shell_.high; }  ///< [m]
  [[nodiscard]] double volume() const { return volume_; }         ///< [m3] of the interior
  /// Of the triangles' corners: what names this surface in files.
  [[nodiscard]] std::uint64_t digest() const { return digest_; }

  /// [m3] of the interior below a height [m]. To rounding: triangles are cut at the height. Cost: O(triangles).
  [[nodiscard]] double volume_below(double height) const;
  /// [m3] of the part of it that has coordinate `axis` (0 or 1) below `limit` [m]. To rounding.
  [[nodiscard]] double volume_below(double height, std::size_t axis, double limit) const;
  /// [m3] of the interior between two heights that is `margin` [m] away from the surface at least: exact if that is 0,
  /// else by 110,592 points of a grid, within a percent.
  [[nodiscard]] double volume_within(double margin, double low, double high) const;
  /// [m2] of the surface below a height, without what lies flat.
  [[nodiscard]] double walls_below(double height) const;
  /// [m2] of the interior's section at a height; of a floor that lies in it, what is right below.
  [[nodiscard]] double area_at(double height) const;

  /// Does any of the surface lie inside the box from `low` to `high`?
  [[nodiscard]] bool meets_box(const Vec3& low, const Vec3& high) const;

  /// The nearest place of the surface, and on which side of it the point is, told by the angles of the triangles there
  /// (Baerentzen and Aanaes 2005).
  [[nodiscard]] Nearest nearest(const Vec3& x) const;
  /// [m] to the surface, negative outside; cut at `range` in the interior and at -range outside of it. Cheap where it
  /// is farther.
  [[nodiscard]] double distance(const Vec3& x, double range) const;

  /// Is x in the interior and at least `r` [m] away from the surface, r above 0? As distance(x, r) >= r says, to the
  /// bit, but without looking for the nearest place.
  [[nodiscard]] bool fits(const Vec3& x, double r) const;

  /// How far outside the interior x is [m]; inside it a negative number, not more than the distance. NaN if a
  /// coordinate is.
  [[nodiscard]] double beyond(const Vec3& x) const;
  /// Is x in no cell of the grid that the interior reaches into? What is outside and not far from the surface may not
  /// be known to be.
  [[nodiscard]] bool surely_outside(const Vec3& x) const {
    return clear_[static_cast<std::size_t>(grid_.cell_of(x))] < 0;
  }
  /// A place for uniform numbers `u` in [0, 1): evenly over where a sphere of radius `r` [m] fits whose centre is
  /// between two heights [m]. By rejection, 256 times at most; if that finds none, the height is NaN.
  [[nodiscard]] Vec3 draw(const Vec3& u, double r, double low, double high) const;

  [[nodiscard]] const Features& features() const { return features_; }
  /// Is all of the surface `range` [m] away from x, as cells of the grid tell at once? It may be where they do not.
  [[nodiscard]] bool is_clear(const Vec3& x, double range) const {
    return (std::abs(clear_[static_cast<std::size_t>(grid_.cell_of(x))]) - 1) * grid_.width() >= range;
  }
  /// All features that are nearer to x than `range` [m], and some faces that are not; but not more than `deepest` [m]
  /// and the range on the other side of x.
  void near(const Vec3& x, double range, double deepest, NearFeatures& found) const;
  /// Where a feature is, seen from x. See Table for `deepest`.
  [[nodiscard]] Touch touch_of(std::int32_t feature, const Vec3& x, double deepest) const;

  /// Calls found(feature, touch) for each that is nearer to x than `range` [m].
  void touches(const Vec3& x, double range, double deepest,
               const std::function<void(std::int32_t, const Touch&)>& found) const;

  /// [m3] of a sphere what is in the interior. In closed form, to rounding.
  [[nodiscard]] double volume_of_sphere(const Vec3& x, double r) const;

 private:
  struct Hit {
    double squared;
    Vec3 place;
    int triangle, feature;  // corner 0, 1, 2; edge 3, 4, 5; 6 its inside
  };
  /// Of a triangle, in one line of memory, what tells that most others are not near.
  struct alignas(64) Spot {
    Vec3 normal, middle;
    double reach;  // [m] from the middle to the farthest corner
  };
  [[nodiscard]] Hit hit(const Vec3& x, int triangle) const;
  [[nodiscard]] bool may_be_near(const Vec3& x, int triangle, double range) const;
  [[nodiscard]] Vec3 outward(const Hit& hit) const;
  /// Above 0: x is in the interior, below: outside. No triangle is nearer than `clear` [m].
  [[nodiscard]] int side_of(const Vec3& x, double clear) const;
  void weigh_points();
  void fill_cells();

  Shell shell_;
  Grid grid_;
  Features features_;
  std::vector<Spot> spot_;           // of triangles
  std::vector<Vec3> point_;          // normals of points, weighted by angles
  std::vector<std::int16_t> clear_;  // of a cell: steps to one that the surface meets, negative outside the interior
  double volume_ = 0.0;
  std::uint64_t digest_ = 0;
};

}  // namespace packmpi::mesh
