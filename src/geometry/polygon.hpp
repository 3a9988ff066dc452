/// Convex rooms in the plane between straight sides.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "base/types.hpp"

namespace packmpi::geometry {

/// A straight side, of which a point x is offset - normal x away [m]; the unit vector points out of the interior.
struct Side {
  Vec3 normal{};
  double offset = 0.0;  ///< [m]
  [[nodiscard]] constexpr double distance(const Vec3& x) const {
    return offset - (normal[0] * x[0] + normal[1] * x[1]);
  }
};

/// Of a convex polygon, anticlockwise [m].
using Corners = std::vector<std::array<double, 2>>;

/// [m2]
[[nodiscard]] double area_of(const Corners& corners) noexcept;

/// [m2] of a disc of radius `r` at `x` what lies in the polygon. In closed form.
[[nodiscard]] double area_in_polygon(double r, const Vec3& x, const Corners& corners) noexcept;

/// An interior on the inner side of each of some sides, between x = 0 and x = width. A horizontal side at y = 0 is its
/// floor.
class Polygon {
 public:
  /// Between these corners, whose lowest coordinates are 0. Precondition: convex, anticlockwise, three or more.
  explicit Polygon(const Corners& corners);
  /// A trapezium on a floor, that is `bottom` wide there and `top` at a height (all [m]). Above it one that widens goes
  /// on as wide as it is, one that narrows up to its tip.
  Polygon(double bottom, double top, double height);

  [[nodiscard]] constexpr double width() const { return width_; }  ///< [m]
  [[nodiscard]] constexpr double top() const { return top_; }      ///< [m] of its highest point; infinite if it is open
  /// Has it the wall of this number: 0 the floor, 1 and 2 upright ones at x = 0 and x = width?
  [[nodiscard]] constexpr bool has_plane(std::size_t number) const { return number < 3 && planes_[number]; }
  /// All other sides.
  [[nodiscard]] constexpr const std::vector<Side>& sloping() const { return sloping_; }

  /// From the nearest side but the floor [m]; negative: behind it. NaN if a coordinate is.
  [[nodiscard]] double from_sides(const Vec3& x) const noexcept;
  /// How wide it is at a height, but for what is nearer to its sides than `margin` (all [m]).
  [[nodiscard]] double width_at(double height, double margin = 0.0) const noexcept;
  /// Of its sides but the floor up to a height [m]: [m].
  [[nodiscard]] double sides_below(double height) const;
  /// What is at least `margin` away from all sides but the floor, between two heights and between two places along x
  /// (all [m]).
  [[nodiscard]] Corners within(double margin, double low, double high, double from, double to) const;
  [[nodiscard]] Corners within(double margin, double low, double high) const {
    return within(margin, low, high, 0.0, width_);
  }
  /// The place in such an interior of two uniform numbers in [0, 1): evenly over it. z is NaN if there is none.
  [[nodiscard]] Vec3 draw(const Vec3& u, double margin, double low, double high) const;

 private:
  void add(const Side& side);

  double width_ = 0.0, top_ = 0.0;
  std::array<bool, 3> planes_{};
  std::vector<Side> sides_, sloping_;  // all but the floor; of them those that are no planes
};

}  // namespace packmpi::geometry
