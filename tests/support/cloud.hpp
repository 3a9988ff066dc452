/// A random heap of particles with lists, for kernel tests: overlapping, at and beyond walls, with ghosts.
#pragma once
#include <cstdint>
#include <memory>
#include <random>
#include <vector>

#include "dynamics/kernel.hpp"

namespace packmpi::support {

/// Doubles in [0, 1) from a standard engine: std:: distributions are not the same everywhere.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double operator()(double low, double high) { return low + (high - low) * (*this)(); }
  std::uint64_t below(std::uint64_t n) { return engine_() % n; }

 private:
  std::mt19937_64 engine_;
};

/// 64 bytes, aligned.
struct alignas(64) Line {
  std::int64_t sums[8] = {};
};

struct CloudPlan {
  LocalIndex owned = 150;
  LocalIndex ghosts = 40;
  double skin = 0.1;            ///< [r] pairs within R + skin are listed
  LocalIndex window = 1 << 30;  ///< list only pairs of owned with second - first below this
  double ring_slack = 1.0;      ///< slots of the ring, at least this times the window
  bool round = false;           ///< round walls stand around, where no axis is periodic
  bool mesh = false;            ///< in 3D walls are those of a mesh: an interior with a cube in it
  bool near_field = false;      ///< the ring holds every particle, prefilled
  std::uint64_t seed = 1;
};

/// Owns everything a step needs. Particle i has id ids[i].
struct Cloud {
  Cloud(const scene::Features& features, const CloudPlan& plan);
  /// The same particles in another order, lists made anew and shuffled; ghosts stay ghosts.
  [[nodiscard]] Cloud renumbered(std::uint64_t seed) const;
  [[nodiscard]] dynamics::StepData data();
  [[nodiscard]] bool ring_is_clear() const;
  /// What the pair has stored, oriented from the lower id, or of a wall, whose number is -1 - second. Zeros if not
  /// listed.
  [[nodiscard]] std::vector<double> stored(GlobalId first, GlobalId second) const;
  [[nodiscard]] const double* record(LocalIndex i) const {
    return records.data() + static_cast<std::ptrdiff_t>(i) * features.layout().stride;
  }

  scene::Features features;
  CloudPlan plan;
  std::vector<double> records;  // and padding, as the store has it
  std::vector<GlobalId> ids;
  neighbor::PairList pairs;
  neighbor::WallList walls;
  std::vector<double> pair_stored, wall_stored;  // as dynamics::StoredVectors has them
  dynamics::Law law{};
  Vec3 size{};
  std::array<bool, 2> periodic{};
  std::shared_ptr<const mesh::Surface> interior;  // of a mesh
  std::vector<Line> ring;
  std::int64_t ring_mask = 0;
  double drag = 0.0;

 private:
  void fill(Dice& dice);
  void list(Dice& dice);
  void make_ring(Dice& dice);
  void remember(Dice& dice);
  [[nodiscard]] geometry::RoundWalls round_walls() const;
};

}  // namespace packmpi::support
