#include "observe/size_match.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace packmpi::observe {
namespace {

using input::Weighting;

constexpr std::array<int, 5> tenths{1, 3, 5, 6, 9};
constexpr std::size_t points = tenths.size();
constexpr int edges_a_weighting = 8192;
constexpr int mass_bits = 57;  // ten times the mass of all must fit into 63 bits

// Particles and mass, in integers: sums do not depend on the order.
struct Weight {
  std::int64_t number = 0, mass = 0;
};

// This rank's radii, ascending, with the weight of all before each.
class Sample {
 public:
  Sample(const comm::Comm& comm, const particles::Store& store) {
    const auto count = static_cast<std::size_t>(store.owned());
    radii_.reserve(count);
    for (LocalIndex i = 0; i < store.owned(); ++i) radii_.push_back(store.radius(i));
    std::ranges::sort(radii_);
    all_.number = comm.sum(std::int64_t{store.owned()});
    largest_ = comm.max(radii_.empty() ? 0.0 : radii_.back());
    smallest_ = comm.min(radii_.empty() ? std::numeric_limits<double>::infinity() : radii_.front());
    // The largest particle weighs 2^bits, all together 2^mass_bits at most.
    const int bits = mass_bits - static_cast<int>(std::bit_width(static_cast<std::uint64_t>(all_.number)));
    masses_.reserve(count + 1);
    masses_.push_back(0);
    for (const double r : radii_) {
      const double share = r / largest_;
      masses_.push_back(masses_.back() + std::llround(std::ldexp(share * share * share, bits)));
    }
    all_.mass = comm.sum(masses_.back());
  }

  [[nodiscard]] const Weight& all() const { return all_; }  // on all ranks
  [[nodiscard]] double smallest() const { return smallest_; }
  [[nodiscard]] double largest() const { return largest_; }
  [[nodiscard]] Weight up_to(double r) const { return before(std::ranges::upper_bound(radii_, r)); }
  [[nodiscard]] Weight below(double r) const { return before(std::ranges::lower_bound(radii_, r)); }

 private:
  [[nodiscard]] Weight before(std::vector<double>::const_iterator place) const {
    const auto count = place - radii_.begin();
    return {count, masses_[static_cast<std::size_t>(count)]};
  }
  std::vector<double> radii_;
  std::vector<std::int64_t> masses_;
  Weight all_;
  double smallest_ = 0.0, largest_ = 0.0;
};

std::int64_t bits_of(double r) { return std::bit_cast<std::int64_t>(r); }  // in the order of positive doubles
double radius_of(std::int64_t bits) { return std::bit_cast<double>(bits); }

SizePoints diameters(const double* r) { return {2.0 * r[0], 2.0 * r[1], 2.0 * r[2], 2.0 * r[3], 2.0 * r[4]}; }

// All ten diameters at once, by halving the bit patterns between the smallest and the largest radius.
void find_got(const comm::Comm& comm, const Sample& sample, SizeMatches& matches) {
  std::array<std::int64_t, 2 * points> low;   // too small
  std::array<std::int64_t, 2 * points> high;  // large enough
  low.fill(bits_of(sample.smallest()) - 1);
  high.fill(bits_of(sample.largest()));
  while (true) {
    std::array<std::int64_t, 2 * points> middle{};
    std::array<std::int64_t, 2 * points> weight{};
    bool open = false;
    for (std::size_t k = 0; k < middle.size(); ++k) {
      open = open || high[k] - low[k] > 1;
      middle[k] = low[k] + (high[k] - low[k]) / 2;
      const Weight here = sample.up_to(radius_of(middle[k]));
      weight[k] = k < points ? here.number : here.mass;
    }
    if (!open) break;
    comm.sum(weight);
    for (std::size_t k = 0; k < middle.size(); ++k) {
      if (high[k] - low[k] <= 1) continue;
      const std::int64_t all = k < points ? sample.all().number : sample.all().mass;
      (10 * weight[k] >= tenths[k % points] * all ? high : low)[k] = middle[k];
    }
  }
  std::array<double, 2 * points> radii{};
  std::ranges::transform(high, radii.begin(), radius_of);
  matches.by_number.achieved = diameters(radii.data());
  matches.by_mass.achieved = diameters(radii.data() + points);
}

SizePoints asked(const scene::SizeCurve& curve, Weighting weighting) {
  std::array<double, points> radii{};
  for (std::size_t k = 0; k < points; ++k) radii[k] = curve.quantile(weighting, tenths[k] / 10.0);
  return diameters(radii.data());
}

std::vector<double> edges_of(const scene::SizeCurve& curve) {
  std::vector<double> edges = curve.corners();
  if (edges.size() > 1) {
    for (const Weighting weighting : {Weighting::number, Weighting::mass}) {
      for (int k = 1; k < edges_a_weighting; ++k) {
        edges.push_back(curve.quantile(weighting, static_cast<double>(k) / edges_a_weighting));
      }
    }
  }
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

// Both curves have a limit from the left and a value at each edge.
void find_distances(const comm::Comm& comm, const Sample& sample, const scene::SizeCurve& curve, SizeMatches& matches) {
  const std::vector<double> edges = edges_of(curve);
  std::vector<std::int64_t> sums;
  sums.reserve(4 * edges.size());
  for (const double edge : edges) {
    const Weight below = sample.below(edge);
    const Weight up_to = sample.up_to(edge);
    for (const std::int64_t sum : {below.number, up_to.number, below.mass, up_to.mass}) sums.push_back(sum);
  }
  comm.sum(sums);
  const auto apart = [&](Weighting weighting, double r, std::int64_t sum, std::int64_t all) {
    return std::abs(curve.passing(weighting, r) - static_cast<double>(sum) / static_cast<double>(all));
  };
  double& by_number = matches.by_number.distance;
  double& by_mass = matches.by_mass.distance;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const double before = std::nextafter(edges[k], 0.0);
    const std::int64_t* sum = &sums[4 * k];
    by_number = std::max({by_number, apart(Weighting::number, before, sum[0], sample.all().number),
                          apart(Weighting::number, edges[k], sum[1], sample.all().number)});
    by_mass = std::max({by_mass, apart(Weighting::mass, before, sum[2], sample.all().mass),
                        apart(Weighting::mass, edges[k], sum[3], sample.all().mass)});
  }
}

}  // namespace

SizeMatches size_match(const comm::Comm& comm, const particles::Store& store, const scene::SizeCurve& curve) {
  SizeMatches matches;
  matches.by_number.target = asked(curve, Weighting::number);
  matches.by_mass.target = asked(curve, Weighting::mass);
  const Sample sample(comm, store);
  if (sample.all().number == 0) return matches;
  find_got(comm, sample, matches);
  find_distances(comm, sample, curve, matches);
  return matches;
}

}  // namespace packmpi::observe
