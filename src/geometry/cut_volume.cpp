#include "geometry/cut_volume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/elementary.hpp"
#include "geometry/gauss.hpp"
#include "geometry/volume.hpp"

namespace packmpi::geometry {
namespace {

// Of a disc of radius s the part with x < a and y < b.
double corner_of_disc(double s, double a, double b) {
  if (a <= -s || b <= -s) return 0.0;
  const double below_a = volume_below(2, s, 0.0, std::min(a, s)), below_b = volume_below(2, s, 0.0, std::min(b, s));
  if (a >= s) return below_b;
  if (b >= s) return below_a;
  if (a * a + b * b >= s * s) {  // the corner is outside
    if (a <= 0.0) return b <= 0.0 ? 0.0 : below_a;
    return b <= 0.0 ? below_b : std::max(0.0, below_a + below_b - volume(2, s));
  }
  const auto half = [&](double t) {
    return 0.5 * (t * std::sqrt((s - t) * (s + t)) + s * s * elementary::arcsine(t / s));
  };
  return a * b + half(a) + half(b) + 0.25 * std::numbers::pi * s * s;
}

// Of a disc the part in the rectangle, seen from its centre.
double rectangle_of_disc(double s, const Vec3& low, const Vec3& high) {
  return corner_of_disc(s, high[0], high[1]) - corner_of_disc(s, low[0], high[1]) - corner_of_disc(s, high[0], low[1]) +
         corner_of_disc(s, low[0], low[1]);
}

// Heights at which a section begins or ends to meet a side or a corner, in order, from the lowest to the highest.
struct Heights {
  std::array<double, 18> at{};
  std::size_t count = 0;

  Heights(double r, const Vec3& low, const Vec3& high) {
    const double bottom = std::clamp(low[2], -r, r), top = std::clamp(high[2], -r, r);
    at[count++] = bottom, at[count++] = top;
    const auto note = [&](double square) {
      if (!(square < r * r)) return;
      const double z = std::sqrt(r * r - square);
      if (z > bottom && z < top) at.at(count++) = z;
      if (-z > bottom && -z < top) at.at(count++) = -z;
    };
    for (const double x : {low[0], high[0]}) {
      note(x * x);
      for (const double y : {low[1], high[1]}) note(x * x + y * y);
    }
    for (const double y : {low[1], high[1]}) note(y * y);
    std::sort(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(count));
  }
};

}  // namespace

double area_in_rectangle(double r, const Vec3& low, const Vec3& high) noexcept {
  return low[0] < high[0] && low[1] < high[1] ? rectangle_of_disc(r, low, high) : 0.0;
}

double volume_in_sphere(double r, double b, double around) noexcept {
  if (b + r <= around) return volume(3, r);
  if (b >= around + r) return 0.0;
  if (b + around <= r) return volume(3, around);
  const double own = (around - b + r) * (around + b - r) / (2.0 * b);
  const double other = (r - b + around) * (r + b - around) / (2.0 * b);
  return volume_below(3, r, r, own) + volume_below(3, around, around, other);
}

double volume_in_box(double r, const Vec3& low, const Vec3& high) noexcept {
  for (std::size_t a = 0; a < 3; ++a) {
    if (low[a] >= r || high[a] <= -r || !(low[a] < high[a])) return 0.0;
  }
  const bool upright = low[0] <= -r && low[1] <= -r && high[0] >= r && high[1] >= r;
  if (upright) return volume_below(3, r, 0.0, high[2]) - volume_below(3, r, 0.0, low[2]);
  const Heights heights(r, low, high);
  double sum = 0.0;
  for (std::size_t k = 0; k + 1 < heights.count; ++k) {
    sum += integral([&](double z) { return rectangle_of_disc(std::sqrt(std::max(0.0, (r - z) * (r + z))), low, high); },
                    heights.at.at(k), heights.at.at(k + 1));
  }
  return sum;
}

}  // namespace packmpi::geometry
