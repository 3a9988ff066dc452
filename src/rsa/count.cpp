#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "geometry/volume.hpp"
#include "rsa/insert.hpp"
#include "scene/mixture.hpp"

namespace packmpi::rsa {
namespace {

constexpr std::int64_t none = std::numeric_limits<std::int64_t>::max();
constexpr int most_blocks = 10000;  // two or three are needed

// The smallest n with n * volume >= target.
std::int64_t count_of_equals(double target, double volume) {
  auto n = std::max<std::int64_t>(1, static_cast<std::int64_t>(target / volume));
  while (n > 1 && static_cast<double>(n - 1) * volume >= target) --n;
  while (static_cast<double>(n) * volume < target) ++n;
  return n;
}

// Adds up volumes as integers, so that the sum does not depend on how the particles are dealt out.
class Tally {
 public:
  Tally(const scene::Scene& scene, const LayerRegion& region, double target)
      : scene_(&scene),
        region_(region),
        quanta_(std::scalbn(1.0, 55 - std::ilogb(target))),
        target_(to_quanta(target)) {}

  // Goes through [begin, end) of this rank and the blocks of the ranks above it. Collective. The count at which the
  // target is reached, or `none`; then the blocks have been added.
  std::int64_t add_blocks(const comm::Comm& comm, std::int64_t begin, std::int64_t end) {
    std::vector<std::int64_t> volumes;
    volumes.reserve(static_cast<std::size_t>(end - begin));
    std::int64_t mine = 0;
    for (std::int64_t k = begin; k < end; ++k) {
      const double radius = scene_->sizes.draw(region_.layer, static_cast<std::uint64_t>(k), region_.first_id);
      volumes.push_back(to_quanta(geometry::volume(scene_->container.dimension, radius)));
      mine += volumes.back();
    }
    std::int64_t reached = none;
    std::int64_t sum = sum_ + comm.sum_below(mine);
    for (std::size_t k = 0; k < volumes.size() && reached == none; ++k) {
      sum += volumes[k];
      if (sum >= target_) reached = begin + static_cast<std::int64_t>(k) + 1;
    }
    sum_ += comm.sum(mine);
    return comm.min(reached);
  }
  [[nodiscard]] double missing() const { return static_cast<double>(target_ - sum_) / quanta_; }

 private:
  [[nodiscard]] std::int64_t to_quanta(double volume) const { return std::llrint(volume * quanta_); }

  const scene::Scene* scene_;
  LayerRegion region_;
  double quanta_;  // a unit of volume, in quanta; the target is 2^55 to 2^56 of them
  std::int64_t target_;
  std::int64_t sum_ = 0;
};

std::int64_t needed_for_fraction(const comm::Comm& comm, const scene::Scene& scene, const LayerRegion& region) {
  const double target =
      scene.in.layers.fraction * scene.container.mean_area(region.bottom, region.thickness) * region.thickness;
  const int power = scene.container.dimension;
  const double mean = geometry::volume(power, 1.0) * scene.sizes.curve().moment(power);
  if (!(target > 0.0) || !(mean > 0.0))
    comm::fail_together(comm, ExitCode::bad_input, "layers: fraction, thickness and radii must be positive");
  if (scene.sizes.equal()) return count_of_equals(target, geometry::volume(power, scene.sizes.largest()));
  Tally tally(scene, region, target);
  std::int64_t done = 0;
  for (int block = 0; block < most_blocks; ++block) {
    const std::int64_t each = static_cast<std::int64_t>(tally.missing() / mean / comm.size()) + 1;
    const std::int64_t begin = done + comm.rank() * each;
    const std::int64_t reached = tally.add_blocks(comm, begin, begin + each);
    if (reached != none) return reached;
    done += each * comm.size();
  }
  throw std::logic_error("rsa: the particles' volume does not grow");
}

}  // namespace

Drawn drawn(const scene::Scene& scene, const LayerRegion& region, std::uint64_t index) {
  if (region.portions.empty()) return {scene.sizes.draw(region.layer, index, region.first_id), 0};
  auto number = static_cast<std::int64_t>(index);
  std::size_t k = 0;
  for (; k + 1 < region.portions.size() && number >= region.portions[k].count; ++k) number -= region.portions[k].count;
  const Portion& of = region.portions[k];
  return {scene::radius_of(scene, of.component, static_cast<std::uint64_t>(of.first + number)), of.component};
}

std::int64_t particles_needed(const comm::Comm& comm, const scene::Scene& scene, const LayerRegion& region) {
  if (!region.portions.empty()) {
    std::int64_t all = 0;
    for (const Portion& portion : region.portions) all += portion.count;
    return all;
  }
  const std::int64_t count = scene.in.particles.count;
  if (count > 0 && insertion_alone(scene.in)) return count;
  const std::int64_t needed = needed_for_fraction(comm, scene, region);
  return count > 0 ? std::min(needed, count - region.first_id) : needed;
}

}  // namespace packmpi::rsa
