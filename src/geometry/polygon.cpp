#include "geometry/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/elementary.hpp"
#include "geometry/volume.hpp"

namespace packmpi::geometry {
namespace {

using Corner = std::array<double, 2>;

double cross(const Corner& a, const Corner& b) { return a[0] * b[1] - a[1] * b[0]; }
double length_of(double x, double y) { return std::sqrt(x * x + y * y); }

// Of a disc about the origin the sector between the directions of a and b, negative if it goes round clockwise.
double sector(double r, const Corner& a, const Corner& b) {
  const double la = length_of(a[0], a[1]), lb = length_of(b[0], b[1]);
  const Corner u{a[0] / la, a[1] / la}, sum{u[0] + b[0] / lb, u[1] + b[1] / lb};
  const double length = length_of(sum[0], sum[1]);
  const double half = 0.5 * length_of(u[0] - sum[0] / length, u[1] - sum[1] / length);  // sine of a quarter of it
  return std::copysign(2.0 * elementary::arcsine(std::min(1.0, half)) * r * r, cross(a, b));
}

// Of that disc what lies between its centre and the line from a to b, likewise.
double wedge(double r, const Corner& a, const Corner& b) {
  const Corner d{b[0] - a[0], b[1] - a[1]};
  const double square = d[0] * d[0] + d[1] * d[1], along = a[0] * d[0] + a[1] * d[1], area = cross(a, b);
  const double root = r * r * square - area * area;  // of (a + t d)^2 = r^2
  if (area == 0.0) return 0.0;
  if (!(root > 0.0)) return sector(r, a, b);
  const double half = std::sqrt(root), enters = (-along - half) / square, leaves = (-along + half) / square;
  if (leaves <= 0.0 || enters >= 1.0) return sector(r, a, b);
  const auto at = [&](double t) { return Corner{a[0] + t * d[0], a[1] + t * d[1]}; };
  const Corner p = enters > 0.0 ? at(enters) : a, q = leaves < 1.0 ? at(leaves) : b;
  return (enters > 0.0 ? sector(r, a, p) : 0.0) + 0.5 * cross(p, q) + (leaves < 1.0 ? sector(r, q, b) : 0.0);
}

}  // namespace

double area_of(const Corners& corners) noexcept {
  double twice = 0.0;
  for (std::size_t k = 2; k < corners.size(); ++k) {
    const auto &o = corners[0], &a = corners[k - 1], &b = corners[k];
    twice += cross({a[0] - o[0], a[1] - o[1]}, {b[0] - o[0], b[1] - o[1]});
  }
  return 0.5 * twice;
}

double area_in_polygon(double r, const Vec3& x, const Corners& corners) noexcept {
  double area = 0.0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto &a = corners[k], &b = corners[k + 1 < corners.size() ? k + 1 : 0];
    area += wedge(r, {a[0] - x[0], a[1] - x[1]}, {b[0] - x[0], b[1] - x[1]});
  }
  return std::clamp(area, 0.0, volume(2, r));
}

void Polygon::add(const Side& side) {
  const auto is = [&](double x, double y, double offset) {
    return side.normal[0] == x && side.normal[1] == y && side.offset == offset;
  };
  if (is(0.0, -1.0, 0.0)) {
    planes_[0] = true;
    return;
  }
  sides_.push_back(side);
  if (is(-1.0, 0.0, 0.0)) {
    planes_[1] = true;
  } else if (is(1.0, 0.0, width_)) {
    planes_[2] = true;
  } else {
    sloping_.push_back(side);
  }
}

Polygon::Polygon(const Corners& corners) {
  for (const Corner& corner : corners) width_ = std::max(width_, corner[0]), top_ = std::max(top_, corner[1]);
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto &a = corners[k], &b = corners[k + 1 < corners.size() ? k + 1 : 0];
    const double length = length_of(b[0] - a[0], b[1] - a[1]);
    const Vec3 normal{(b[1] - a[1]) / length, (a[0] - b[0]) / length, 0.0};
    add({normal, normal[0] * a[0] + normal[1] * a[1]});
  }
}

Polygon::Polygon(double bottom, double top, double height) : width_(std::max(bottom, top)) {
  const double middle = 0.5 * width_, rise = 0.5 * (top - bottom) / height, cosine = 1.0 / std::sqrt(1.0 + rise * rise);
  top_ = top < bottom ? bottom * height / (bottom - top) : HUGE_VAL;
  add({{0.0, -1.0, 0.0}, 0.0});
  add({{-cosine, -(rise * cosine), 0.0}, (0.5 * bottom - middle) * cosine});
  add({{cosine, -(rise * cosine), 0.0}, (0.5 * bottom + middle) * cosine});
  if (!(top > bottom)) return;
  add({{-1.0, 0.0, 0.0}, 0.0});
  add({{1.0, 0.0, 0.0}, width_});
}

double Polygon::from_sides(const Vec3& x) const noexcept {
  double least = HUGE_VAL;
  for (const Side& side : sides_) {
    const double here = side.distance(x);
    if (here < least || here != here) least = here;
  }
  return least;
}

double Polygon::width_at(double height, double margin) const noexcept {
  double low = 0.0, high = width_;
  for (const auto& [normal, offset] : sides_) {
    const double left = offset - margin - normal[1] * height;
    if (normal[0] > 0.0) high = std::min(high, left / normal[0]);
    if (normal[0] < 0.0) low = std::max(low, left / normal[0]);
    if (normal[0] == 0.0 && left < 0.0) return 0.0;
  }
  return std::max(0.0, high - low);
}

double Polygon::sides_below(double height) const {
  const Corners below = within(0.0, 0.0, height);
  double around = 0.0;
  for (std::size_t k = 0; k < below.size(); ++k) {
    const auto &a = below[k], &b = below[k + 1 < below.size() ? k + 1 : 0];
    around += length_of(b[0] - a[0], b[1] - a[1]);
  }
  return around - (planes_[0] ? width_at(0.0) : 0.0) - (height < top_ ? width_at(height) : 0.0);
}

Corners Polygon::within(double margin, double low, double high, double from, double to) const {
  if (!(low < high && from < to)) return {};
  Corners here{{from, low}, {to, low}, {to, high}, {from, high}}, next;
  for (const Side& side : sides_) {
    next.clear();
    for (std::size_t k = 0; k < here.size(); ++k) {
      const auto &a = here[k], &b = here[k + 1 < here.size() ? k + 1 : 0];
      const double at_a = side.distance({a[0], a[1], 0.0}) - margin, at_b = side.distance({b[0], b[1], 0.0}) - margin;
      if (at_a >= 0.0) next.push_back(a);
      if ((at_a >= 0.0) == (at_b >= 0.0)) continue;
      const double t = at_a / (at_a - at_b);
      next.push_back({a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])});
    }
    here.swap(next);
  }
  return here;
}

Vec3 Polygon::draw(const Vec3& u, double margin, double low, double high) const {
  const Corners interior = within(margin, low, high);
  double left = u[0] * area_of(interior);
  for (std::size_t k = 2; k < interior.size(); ++k) {  // triangles around its first corner
    const auto &o = interior[0], &a = interior[k - 1], &b = interior[k];
    const double here = area_of({o, a, b});
    if (left >= here && k + 1 < interior.size()) {
      left -= here;
      continue;
    }
    if (!(here > 0.0)) break;
    const double out = std::sqrt(u[1]), across = std::clamp(left / here, 0.0, 1.0);
    const auto at = [&](std::size_t c) { return o[c] + out * (a[c] + across * (b[c] - a[c]) - o[c]); };
    return {at(0), at(1), 0.0};
  }
  return {0.5 * width_, low, std::nan("")};
}

}  // namespace packmpi::geometry
