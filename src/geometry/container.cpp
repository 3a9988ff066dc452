#include "geometry/container.hpp"

#include <algorithm>

#include "base/elementary.hpp"

namespace packmpi::geometry {
namespace {

// Evenly over a disc: equal areas lie within equal shares of the squared radius.
Vec3 draw_in_disc(const RoundWall& wall, const Vec3& u, double radius) {
  const double rho = std::max(0.0, wall.offset - radius) * std::sqrt(u[0]);
  const double turn = 4.0 * u[1];  // in quarters; within one the series of the functions hold
  const int quarter = std::min(3, static_cast<int>(turn));
  const double angle = 0.5 * std::numbers::pi * (turn - quarter);
  const double c = rho * elementary::cosine(angle), s = rho * elementary::sine(angle);
  const std::array<std::array<double, 2>, 4> places{{{c, s}, {-s, c}, {-c, -s}, {s, -c}}};
  const auto& [x, y] = places.at(static_cast<std::size_t>(quarter));
  return {wall.axis[0] + x, wall.axis[1] + y, 0.0};
}

}  // namespace

Vec3 Container::draw(const Vec3& u, double radius) const {
  if (!is_box()) return draw_in_disc(round(0), u, radius);
  Vec3 place{};
  for (std::size_t axis = 0; axis < static_cast<std::size_t>(lateral_axes()); ++axis) {
    place[axis] =
        periodic[axis] ? wrap(u[axis] * size[axis], size[axis]) : radius + u[axis] * (size[axis] - 2.0 * radius);
  }
  return place;
}

}  // namespace packmpi::geometry
