#include "scene/size_curve.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "input/grading.hpp"

namespace packmpi::scene {
namespace {

using elementary::cube_root;
using elementary::exponential;
using elementary::logarithm;
using input::SizeDistribution;
using input::Weighting;

constexpr int smooth_pieces = 4096;
constexpr double farthest = 9.0;  // sd; beyond it there is less than 1e-18 of a normal distribution

// r^e for the exponents that occur.
double raised(double r, int e) {
  double value = 1.0;
  for (int k = 0; k < std::abs(e); ++k) value *= r;
  return e < 0 ? 1.0 / value : value;
}

// The root of raised().
double rooted(double value, int e) {
  switch (e) {
    case 4:
      return std::sqrt(std::sqrt(value));
    case 3:
      return cube_root(value);
    case 2:
      return std::sqrt(value);
    case -1:
      return 1.0 / value;
    case -2:
      return 1.0 / std::sqrt(value);
    case -3:
      return 1.0 / cube_root(value);
    default:
      return value;  // 1
  }
}

// Integral of s^(e - 1) over [a, b]; e times it unless e = 0.
double integral(double a, double b, int e) { return e == 0 ? logarithm(b / a) : (raised(b, e) - raised(a, e)) / e; }

// r with integral(a, r, e) = share * integral(a, b, e).
double inverse(double a, double b, int e, double share) {
  if (!(a < b)) return a;
  const double r =
      e == 0 ? a * elementary::power(b / a, share) : rooted(raised(a, e) + share * (raised(b, e) - raised(a, e)), e);
  return std::clamp(r, a, b);
}

// The power of the radius that a weighting counts particles by.
int counted(Weighting weighting) {
  switch (weighting) {
    case Weighting::number:
      return 0;
    case Weighting::area:
      return 2;
    default:
      return 3;  // mass
  }
}

// Exponent of the integral that counts particles (or mass) where the number density is radius^-power.
int exponent(Weighting weighting, int power) { return counted(weighting) + 1 - power; }

// Mean of radius^moment over the particles of a piece.
double mean_power(double low, double high, int power, int moment) {
  if (!(low < high)) return raised(low, moment);
  return integral(low, high, moment + 1 - power) / integral(low, high, 1 - power);
}

// The power of a piece in which number (or area or mass) is linear in the radius, or in its logarithm.
int linear_power(Weighting weighting) { return counted(weighting); }
int log_power(Weighting weighting) { return counted(weighting) + 1; }

}  // namespace

SizeCurve::SizeCurve(const input::Radius& radius) {
  switch (radius.distribution) {
    case SizeDistribution::equal:
      add_classes({radius.value}, {1.0});
      break;
    case SizeDistribution::uniform:
      add(radius.min, radius.max, linear_power(radius.weighting), 1.0);
      break;
    case SizeDistribution::bidisperse:
      add_classes({radius.small, radius.large}, {1.0 - radius.large_share, radius.large_share});
      break;
    case SizeDistribution::discrete:
      add_classes(radius.radii, radius.shares);
      break;
    case SizeDistribution::list:
      add_list(radius.radii);
      break;
    case SizeDistribution::grading: {
      const input::Curve curve = input::kept_curve(radius);
      const bool log = radius.interpolation == input::Interpolation::log;
      const int power = log ? log_power(radius.weighting) : linear_power(radius.weighting);
      for (std::size_t k = 1; k < curve.size(); ++k) {
        add(0.5 * curve[k - 1][0], 0.5 * curve[k][0], power, curve[k][1] - curve[k - 1][1]);
      }
      break;
    }
    case SizeDistribution::mixture:
      add_parts(radius);
      return;
    default:
      add_smooth(radius);
  }
  finish(radius.weighting);
}

void SizeCurve::add_parts(const input::Radius& radius) {
  double number = 0.0, mass = 0.0;
  for (std::size_t k = 0; k < radius.parts.size(); ++k) {
    Part part{SizeCurve(radius.parts[k]), radius.shares[k], radius.shares[k]};
    const double cube = part.curve.moment(3);
    (radius.weighting == Weighting::number ? part.mass *= cube : part.number /= cube);
    number += part.number, mass += part.mass;
    parts_.push_back(std::move(part));
  }
  for (Part& part : parts_) part.number /= number, part.mass /= mass;
}

double SizeCurve::smallest() const noexcept {
  double least = parts_.empty() ? pieces_.front().low : parts_.front().curve.smallest();
  for (const Part& part : parts_) least = std::min(least, part.curve.smallest());
  return least;
}

double SizeCurve::largest() const noexcept {
  double most = parts_.empty() ? pieces_.back().high : 0.0;
  for (const Part& part : parts_) most = std::max(most, part.curve.largest());
  return most;
}

double SizeCurve::share_of_parts(Weighting weighting, double r) const {
  double share = 0.0;
  for (const Part& part : parts_) {
    share += (weighting == Weighting::number ? part.number : part.mass) * part.curve.passing(weighting, r);
  }
  return r < largest() ? share : 1.0;
}

// Shares are by the distribution's own weighting until finish(). The ends of a curve are where particles are.
void SizeCurve::add(double low, double high, int power, double share) {
  if (share > 0.0) pieces_.push_back({low, high, power, share, share});
}

void SizeCurve::add_classes(const std::vector<double>& radii, const std::vector<double>& shares) {
  for (std::size_t k = 0; k < radii.size(); ++k) add(radii[k], radii[k], 0, shares[k]);
}

void SizeCurve::add_list(std::vector<double> radii) {
  std::ranges::sort(radii);
  for (std::size_t begin = 0, end = 0; begin < radii.size(); begin = end) {
    while (end < radii.size() && radii[end] == radii[begin]) ++end;
    add(radii[begin], radii[begin], 0, static_cast<double>(end - begin));
  }
}

void SizeCurve::add_smooth(const input::Radius& in) {
  const bool gaussian = in.distribution == SizeDistribution::gaussian;
  const bool weibull = in.distribution == SizeDistribution::weibull;
  if (gaussian && !(in.sd > 0.0)) return add_classes({std::clamp(in.mean, in.min, in.max)}, {1.0});
  if (!(in.min < in.max)) return add_classes({in.min}, {1.0});
  // x is the radius of a gaussian, else the logarithm of the radius to the centre's.
  const double centre = weibull ? in.scale : in.median;
  double low = gaussian ? (in.min - in.mean) / in.sd : logarithm(in.min / centre);
  double high = gaussian ? (in.max - in.mean) / in.sd : logarithm(in.max / centre);
  if (in.distribution == SizeDistribution::lognormal) low /= in.log_sd, high /= in.log_sd;
  if (!weibull) low = std::max(low, -farthest), high = std::min(high, farthest);
  const auto radius_at = [&](int k) {
    const double x = low + (high - low) * k / smooth_pieces;
    const double r = gaussian ? in.mean + in.sd * x : centre * exponential(weibull ? x : in.log_sd * x);
    return std::clamp(r, in.min, in.max);
  };
  const auto share = [&](int k) {
    const double a = low + (high - low) * k / smooth_pieces;
    const double b = low + (high - low) * (k + 1) / smooth_pieces;
    if (weibull) return exponential(-exponential(in.shape * a)) - exponential(-exponential(in.shape * b));
    const auto density = [](double z) { return exponential(-0.5 * z * z); };
    return density(a) + 4.0 * density(0.5 * (a + b)) + density(b);  // Simpson's rule
  };
  for (int k = 0; k < smooth_pieces; ++k) {
    const double from = radius_at(k);
    const double to = radius_at(k + 1);
    if (from < to) add(from, to, linear_power(in.weighting), share(k));
  }
}

void SizeCurve::finish(Weighting weighting) {
  double number = 0.0;
  double mass = 0.0;
  for (Piece& piece : pieces_) {
    const double cube = mean_power(piece.low, piece.high, piece.power, 3);
    const bool area = weighting == Weighting::area;
    if (area) piece.mass = piece.number /= mean_power(piece.low, piece.high, piece.power, 2);
    (weighting == Weighting::number || area ? piece.mass *= cube : piece.number /= cube);
    number += piece.number;
    mass += piece.mass;
  }
  double below_number = 0.0;
  double below_mass = 0.0;
  for (Piece& piece : pieces_) {
    piece.number /= number;
    piece.mass /= mass;
    below_number_.push_back(below_number += piece.number);
    below_mass_.push_back(below_mass += piece.mass);
  }
  below_number_.back() = below_mass_.back() = 1.0;
}

double SizeCurve::passing(Weighting weighting, double r) const {
  if (!parts_.empty()) return share_of_parts(weighting, r);
  const auto& below = weighting == Weighting::number ? below_number_ : below_mass_;
  const auto piece = std::ranges::upper_bound(pieces_, r, {}, &Piece::high);  // the first that ends above r
  if (piece == pieces_.end()) return 1.0;
  const auto k = static_cast<std::size_t>(piece - pieces_.begin());
  const double before = k > 0 ? below[k - 1] : 0.0;
  if (!(r > piece->low)) return before;
  const int e = exponent(weighting, piece->power);
  return before + (below[k] - before) * (integral(piece->low, r, e) / integral(piece->low, piece->high, e));
}

double SizeCurve::quantile(Weighting weighting, double share) const {
  if (!parts_.empty()) {
    double low = smallest(), high = largest();  // share_of_parts(high) = 1
    if (share_of_parts(weighting, low) >= share) return low;
    for (double r = 0.5 * (low + high); low < r && r < high; r = 0.5 * (low + high)) {
      (share_of_parts(weighting, r) < share ? low : high) = r;
    }
    return high;
  }
  const auto& below = weighting == Weighting::number ? below_number_ : below_mass_;
  const auto found = std::ranges::lower_bound(below, share);
  const auto k = std::min(static_cast<std::size_t>(found - below.begin()), below.size() - 1);
  const Piece& piece = pieces_[k];
  const double before = k > 0 ? below[k - 1] : 0.0;
  return inverse(piece.low, piece.high, exponent(weighting, piece.power), (share - before) / (below[k] - before));
}

double SizeCurve::moment(int power) const {
  double sum = 0.0;
  for (const Part& part : parts_) sum += part.number * part.curve.moment(power);
  for (const Piece& piece : pieces_) sum += piece.number * mean_power(piece.low, piece.high, piece.power, power);
  return sum;
}

double SizeCurve::draw(double first, double second) const {
  for (const Part& part : parts_) {
    if (first < part.number || &part == &parts_.back())
      return part.curve.draw(std::min(first / part.number, 1.0), second);
    first -= part.number;
  }
  const auto found = std::ranges::upper_bound(below_number_, first);
  const Piece& piece = pieces_[std::min(static_cast<std::size_t>(found - below_number_.begin()), pieces_.size() - 1)];
  return inverse(piece.low, piece.high, exponent(Weighting::number, piece.power), second);
}

std::vector<double> SizeCurve::corners() const {
  std::vector<double> radii;
  for (const Part& part : parts_) {
    const std::vector<double> own = part.curve.corners();
    radii.insert(radii.end(), own.begin(), own.end());
  }
  std::ranges::sort(radii);
  radii.erase(std::unique(radii.begin(), radii.end()), radii.end());
  for (const Piece& piece : pieces_) {
    for (const double r : {piece.low, piece.high}) {
      if (radii.empty() || r > radii.back()) radii.push_back(r);
    }
  }
  return radii;
}

}  // namespace packmpi::scene
