#include "observe/radial_points.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "base/random.hpp"
#include "mesh/surface.hpp"
#include "mesh/vectors.hpp"

namespace packmpi::observe {
namespace {

constexpr int side = 100;  // cells along each axis
constexpr double farthest_in_diameters = 10.0;
constexpr std::int64_t least_points = 400;  // of a shell

/// Cells of the bulk's box, a point in each.
class Points {
 public:
  explicit Points(const Specimen& pack) : seed_(pack.scene.in.seed), interior_(*pack.scene.container.interior) {
    low_ = interior_.low(), high_ = interior_.high();
    low_[2] = pack.bulk.low, high_[2] = pack.bulk.high;
    for (std::size_t a = 0; a < 3; ++a) cell_[a] = (high_[a] - low_[a]) / side;
  }
  [[nodiscard]] Vec3 at(const std::array<int, 3>& cell) const {
    const auto number = (static_cast<std::uint64_t>(cell[2]) * side + static_cast<std::uint64_t>(cell[1])) * side +
                        static_cast<std::uint64_t>(cell[0]);
    const auto u = random::uniforms({seed_, random::Purpose::measure, 0, number, 0});
    Vec3 x{};
    for (std::size_t a = 0; a < 3; ++a) x[a] = low_[a] + (cell[a] + u[a]) * cell_[a];
    return x;
  }
  /// Cells whose points may be in the sphere, along an axis: from, to.
  [[nodiscard]] std::array<int, 2> around(const Vec3& centre, double r, std::size_t axis) const {
    const auto number = [&](double x) {
      return static_cast<int>(std::clamp(std::floor((x - low_[axis]) / cell_[axis]), -1.0, static_cast<double>(side)));
    };
    return {std::max(0, number(centre[axis] - r)), std::min(side - 1, number(centre[axis] + r))};
  }
  [[nodiscard]] const mesh::Surface& interior() const { return interior_; }

 private:
  std::uint64_t seed_;
  const mesh::Surface& interior_;
  Vec3 low_{}, high_{}, cell_{};
};

/// Points by their distance from the surface: shells, then all that is farther.
class Shells {
 public:
  explicit Shells(double diameter)
      : width_(diameter / shells_a_diameter),
        counts_(static_cast<std::size_t>(shells_a_diameter * farthest_in_diameters) + 1, 0) {}
  void add(const mesh::Surface& interior, const Vec3& x) {
    const double end = width_ * static_cast<double>(counts_.size() - 1);
    const double away = interior.distance(x, end);
    if (away < 0.0) return;
    ++counts_[std::min(counts_.size() - 1, static_cast<std::size_t>(away / width_))];
  }
  [[nodiscard]] std::vector<std::int64_t>& counts() { return counts_; }
  [[nodiscard]] double width() const { return width_; }

 private:
  double width_;
  std::vector<std::int64_t> counts_;
};

/// Collective.
std::vector<std::int64_t> interior_points(const Specimen& pack, const Points& points, Shells shells) {
  for (int z = pack.comm.rank(); z < side; z += pack.comm.size()) {
    for (int k = 0; k < side * side; ++k) shells.add(points.interior(), points.at({k % side, k / side, z}));
  }
  pack.comm.sum(std::span(shells.counts()));
  return shells.counts();
}

/// Collective.
std::vector<std::int64_t> solid_points(const Specimen& pack, const Points& points, Shells shells) {
  for (LocalIndex i = 0; i < pack.store.owned(); ++i) {
    const Vec3 centre = pack.store.position(i);
    const double r = pack.store.radius(i);
    std::array<std::array<int, 2>, 3> cells{};
    for (std::size_t a = 0; a < 3; ++a) cells[a] = points.around(centre, r, a);
    for (int z = cells[2][0]; z <= cells[2][1]; ++z) {
      for (int y = cells[1][0]; y <= cells[1][1]; ++y) {
        for (int x = cells[0][0]; x <= cells[0][1]; ++x) {
          const Vec3 place = points.at({x, y, z});
          const Vec3 d = mesh::minus(place, centre);
          if (dot(d, d) < r * r) shells.add(points.interior(), place);
        }
      }
    }
  }
  pack.comm.sum(std::span(shells.counts()));
  return shells.counts();
}

}  // namespace

RadialProfile radial_by_points(const Specimen& pack) {
  const double diameter = 2.0 * pack.scene.sizes.mean();
  const Points points(pack);
  const Shells none(diameter);
  const std::vector<std::int64_t> interior = interior_points(pack, points, none),
                                  solid = solid_points(pack, points, none);
  RadialProfile result;
  result.profile = {.from = 0.0, .width = none.width(), .values = {}};
  for (std::size_t k = 0; k + 1 < interior.size() && interior[k] >= least_points; ++k) {
    result.profile.values.push_back(static_cast<double>(solid[k]) / static_cast<double>(interior[k]));
  }
  result.from_walls = core_in_diameters * diameter;
  const auto first = static_cast<std::ptrdiff_t>(core_in_diameters * shells_a_diameter);
  const auto beyond = [&](const std::vector<std::int64_t>& counts) {
    return std::accumulate(counts.begin() + first, counts.end(), std::int64_t{0});
  };
  if (beyond(interior) >= least_points) {
    result.core = static_cast<double>(beyond(solid)) / static_cast<double>(beyond(interior));
  }
  return result;
}

}  // namespace packmpi::observe
