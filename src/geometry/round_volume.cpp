#include "geometry/round_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/gauss.hpp"
#include "geometry/volume.hpp"

namespace packmpi::geometry {
namespace {

// Of the disc of radius r the segment of height h.
double disc_segment(double r, double h) { return volume_below(2, r, r, std::clamp(h, 0.0, 2.0 * r)); }

// What two discs of radii s and t, whose centres are b apart and which cut each other, have in common.
double lens(double s, double t, double b) {
  if (!(s > 0.0)) return 0.0;
  return disc_segment(s, (t - b + s) * (t + b - s) / (2.0 * b)) +
         disc_segment(t, (s - b + t) * (s + b - t) / (2.0 * b));
}

// u in [0, 1] with u u (3 - 2 u) = share.
double unblended(double share) {
  if (share >= 1.0) return 1.0;
  double low = 0.0, high = 1.0;
  for (int turn = 0; turn < 60; ++turn) {
    const double middle = 0.5 * (low + high);
    (middle * middle * (3.0 - 2.0 * middle) < share ? low : high) = middle;
  }
  return low;
}

// A sphere and a cylinder.
struct Cut {
  double r, b, cylinder;
  double inner, outer;  // heights between which their sections cut each other

  Cut(double radius, double distance, double around) : r(radius), b(distance), cylinder(around) {
    const auto height = [&](double s) { return s < r ? std::sqrt((r - s) * (r + s)) : 0.0; };
    inner = height(cylinder + b);
    outer = height(std::abs(cylinder - b));
  }

  // From the height of the centre up to z in [0, r].
  [[nodiscard]] double up_to(double z) const {
    double volume = std::numbers::pi * cylinder * cylinder * std::min(z, inner);
    if (z > inner && outer > inner) volume += of_lenses(std::min(z, outer));
    if (z > outer && cylinder > b) volume += whole(z) - whole(outer);
    return volume;
  }

 private:
  [[nodiscard]] double whole(double z) const { return std::numbers::pi * z * (r * r - z * z / 3.0); }

  // A section begins and ends to be a lens with a power of a half: blended, both ends are smooth.
  [[nodiscard]] double of_lenses(double z) const {
    const GaussRule& rule = gauss_rule();
    const double width = outer - inner;
    const double end = unblended((z - inner) / width);
    double sum = 0.0;
    for (std::size_t k = 0; k < rule.x.size(); ++k) {
      const double u = end * rule.x.at(k);
      const double at = inner + width * (u * u * (3.0 - 2.0 * u));
      const double s = std::sqrt(std::max(0.0, (r - at) * (r + at)));
      sum += rule.weight.at(k) * (6.0 * u * (1.0 - u)) * lens(s, cylinder, b);
    }
    return sum * width * end;
  }
};

// What two discs have in common.
double common(double s, double t, double b) {
  if (!(s > 0.0) || !(t > 0.0) || b >= s + t) return 0.0;
  if (b <= std::abs(s - t)) return volume(2, std::min(s, t));
  return lens(s, t, b);
}

// Heights at which sections begin, end, or begin or end to cut each other; in order from the lowest to the highest.
struct Breaks {
  std::array<double, 12> at{};
  std::size_t count = 0;
  double low, high;

  Breaks(double from, double to) : low(from), high(to) { at[count++] = from, at[count++] = to; }
  void note(double z) {
    if (z > low && z < high) at.at(count++) = z;
  }
  // Roots of a z^2 + 2 h z + c.
  void note_roots(double a, double h, double c) {
    if (a == 0.0) return note(h == 0.0 ? high : -0.5 * c / h);
    const double square = h * h - a * c;
    if (!(square >= 0.0)) return;
    const double q = -(h + std::copysign(std::sqrt(square), h));
    note(q / a);
    if (q != 0.0) note(c / q);
  }
  // Of what there is from the first to the third of its heights, the second in their middle.
  template <class Piece>
  double over_pieces(const Piece& piece) {
    std::sort(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(count));
    double all = 0.0;
    for (std::size_t k = 0; k + 1 < count; ++k) all += piece(at.at(k), 0.5 * (at.at(k) + at.at(k + 1)), at.at(k + 1));
    return all;
  }
  template <class Section>
  double sum(const Section& section) {
    return over_pieces([&](double from, double middle, double to) {
      return integral(section, from, middle) + integral(section, middle, to);
    });
  }
};

double half_section(double r, double z) { return std::sqrt(std::max(0.0, (r - z) * (r + z))); }

// Of two spheres or discs, the second b beside and `up` above the first.
Breaks breaks_of(double r, double b, double up, double around, double low, double high) {
  Breaks breaks(std::clamp(low, -r, r), std::clamp(high, -r, r));
  const double a = (around - up) * (around + up) + (b - r) * (b + r);  // (a + 2 up z)^2 = 4 b^2 t^2
  breaks.note_roots(4.0 * (up * up + b * b), 2.0 * up * (a - 2.0 * b * b),
                    a * a - 4.0 * b * b * (around - up) * (around + up));
  breaks.note(up - around);
  breaks.note(up + around);
  return breaks;
}

}  // namespace

double volume_in_cone(double r, double b, double radius, double rise, double low, double high) noexcept {
  low = std::clamp(low, -r, r);
  high = std::clamp(high, -r, r);
  if (!(low < high)) return 0.0;
  Breaks breaks(low, high);
  for (const double side : {radius - b, radius + b}) {
    breaks.note_roots(1.0 + rise * rise, rise * side, side * side - r * r);
  }
  if (rise != 0.0) breaks.note(-radius / rise);
  return breaks.sum([&](double z) { return common(half_section(r, z), radius + rise * z, b); });
}

double volume_in_ball(double r, double b, double up, double around, double low, double high) noexcept {
  if (!(std::max(low, -r) < std::min(high, r)) || !(around > 0.0)) return 0.0;
  return breaks_of(r, b, up, around, low, high).sum([&](double z) {
    return common(half_section(r, z), half_section(around, z - up), b);
  });
}

double area_in_disc(double r, double b, double up, double around, double low, double high) noexcept {
  if (!(std::max(low, -r) < std::min(high, r)) || !(around > 0.0)) return 0.0;
  return breaks_of(r, b, up, around, low, high).over_pieces([&](double from, double middle, double to) {
    const double s = half_section(r, middle), t = half_section(around, middle - up);
    if (std::min(s, b + t) <= std::max(-s, b - t)) return 0.0;
    const double own = 0.5 * (volume_below(2, r, 0.0, to) - volume_below(2, r, 0.0, from));
    const double other = 0.5 * (volume_below(2, around, up, to) - volume_below(2, around, up, from));
    const double aside = b * (to - from);  // of the middle of the second one's lines
    return (s < b + t ? own : aside + other) - (-s > b - t ? -own : aside - other);
  });
}

double volume_away_from(const Container& vessel, Surface surface, double margin, const Vec3& x, double r, double low,
                        double high) noexcept {
  if (vessel.is_polygon()) return area_in_polygon(r, x, vessel.polygon->within(margin, low, high));
  const RoundWall wall = vessel.round(static_cast<std::size_t>(surface) - most_planes);
  const double across = x[0] - wall.centre[0], along = x[1] - wall.centre[1];
  const double b = std::sqrt(across * across + along * along + RoundWall::tiny);
  const auto vertical = static_cast<std::size_t>(vessel.vertical());
  const double from = low - x[vertical], to = high - x[vertical];
  if (vessel.dimension == 2) return area_in_disc(r, std::abs(across), -along, wall.offset - margin, from, to);
  if (wall.weight[2] > 0.0) return volume_in_ball(r, b, wall.centre[2] - x[2], wall.offset - margin, from, to);
  if (wall.lean[2] != 0.0) {
    const double rise = -(wall.lean[2] / wall.radial);
    return volume_in_cone(r, b, (wall.offset - margin) / wall.radial + rise * x[2], rise, from, to);
  }
  if (wall.radial > 0.0) return volume_in_cylinder(r, b, wall.offset - margin, from, to);
  const double whole = volume_below(3, r, x[2], high) - volume_below(3, r, x[2], low);
  return whole - volume_in_cylinder(r, b, margin - wall.offset, from, to);
}

double volume_in_cylinder(double r, double b, double cylinder, double low, double high) noexcept {
  if (!(cylinder > 0.0) || b >= cylinder + r) return 0.0;
  low = std::clamp(low, -r, r);
  high = std::clamp(high, -r, r);
  if (b + r <= cylinder) return volume_below(3, r, 0.0, high) - volume_below(3, r, 0.0, low);
  const Cut cut(r, std::max(b, 1e-12 * (cylinder + r)), cylinder);
  const auto at = [&](double z) { return z < 0.0 ? -cut.up_to(-z) : cut.up_to(z); };
  return at(high) - at(low);
}

}  // namespace packmpi::geometry
