#include "geometry/volume.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/elementary.hpp"

namespace packmpi::geometry {
namespace {

constexpr double pi = std::numbers::pi;

/// phi - sin(phi), phi in [0, pi], without the cancellation that leaves nothing of it at small phi.
double arc_minus_sine(double phi) {
  if (phi > 1.0) return phi - elementary::sine(phi);
  const double square = phi * phi;
  double rest = 1.0;  // Horner from the 10th term of phi^3/3! (1 - phi^2/(4 5) (1 - phi^2/(6 7) (...)))
  for (int k = 10; k >= 2; --k) rest = 1.0 - square / (2.0 * k * (2.0 * k + 1.0)) * rest;
  return square * phi / 6.0 * rest;
}

/// Area of the disc's segment of height h <= r; the arc's angle through its half sine, exact near tangency.
double segment(double r, double h) {
  const double phi = 4.0 * elementary::arcsine(std::sqrt(h / (2.0 * r)));
  return 0.5 * r * r * arc_minus_sine(phi);
}

double cap(double r, double h) { return pi * h * h * (3.0 * r - h) / 3.0; }

}  // namespace

double volume(int dimension, double radius) noexcept {
  return dimension == 3 ? 4.0 / 3.0 * pi * (radius * radius * radius) : pi * (radius * radius);
}

double volume_below(int dimension, double radius, double centre, double height) noexcept {
  const double h = (height - centre) + radius;  // how much of the particle's height is below the plane
  if (h <= 0.0) return 0.0;
  const double whole = volume(dimension, radius);
  if (h >= 2.0 * radius) return whole;
  const double part_above = std::max(0.0, radius - (height - centre));
  const double smaller = std::min(h, part_above);
  const double cut = dimension == 3 ? cap(radius, smaller) : segment(radius, smaller);
  return h <= radius ? cut : whole - cut;
}

}  // namespace packmpi::geometry
