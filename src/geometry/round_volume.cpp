#include "geometry/round_volume.hpp"

#include <algorithm>
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

}  // namespace

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
