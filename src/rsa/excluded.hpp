/// The part of a layer that placed spheres exclude, as a map of voxels: most trials of a dense layer are known to
/// overlap by one bit.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "rsa/insert.hpp"
#include "rsa/sphere.hpp"
#include "scene/cell_axis.hpp"

namespace packmpi::rsa {

/// Voxels of this rank's part of a layer of which every point is so near to a placed sphere that no sphere of the scene
/// has room there. Changes no result: what is not excluded may still overlap. Local. Memory: 16 bytes a particle or
/// less.
class Excluded {
 public:
  /// `asked` particles in the whole layer. O(columns + voxels).
  Excluded(const scene::Scene& scene, const scene::Ownership& ownership, const LayerRegion& region, std::int64_t asked);

  /// What a sphere that is placed excludes. Its centre wrapped. O(voxels in its reach).
  void add(const Sphere& placed);
  /// Is there no room for a centre here, one of a trial?
  [[nodiscard]] bool holds(const Vec3& centre) const noexcept {
    const Place at = place(centre);
    return (blocks_[at.block] >> at.bit & 1U) != 0;
  }
  /// Fetches what holds() of this centre will ask for.
  void fetch(const Vec3& centre) const noexcept { __builtin_prefetch(&blocks_[place(centre).block]); }

 private:
  static constexpr int edge = 4;  // voxels along each axis of a block, which is a word

  struct Place {
    std::size_t block;
    unsigned bit;
  };
  [[nodiscard]] Place place(const Vec3& centre) const noexcept {
    const int x = axes_[0].slot(centre[0]) - 1;
    const int y = lateral_ == 2 ? axes_[1].slot(centre[1]) - 1 : 0;
    const int up = vertical_.slot(centre[lateral_ == 2 ? 2 : 1]) - 1;
    return {row(x, y) + static_cast<std::size_t>(up / edge), first_bit(x, y) + static_cast<unsigned>(up % edge)};
  }
  /// The lowest block of a voxel's row of blocks along the vertical, and the lowest bit of it in each.
  [[nodiscard]] std::size_t row(int x, int y) const noexcept {
    return (static_cast<std::size_t>(y / edge) * static_cast<std::size_t>(rows_) + static_cast<std::size_t>(x / edge)) *
           static_cast<std::size_t>(height_);
  }
  [[nodiscard]] static unsigned first_bit(int x, int y) noexcept {
    return static_cast<unsigned>((y % edge * edge + x % edge) * edge);
  }
  /// A voxel along a lateral axis that a reach comes to.
  struct Step {
    int slot;
    double squared;  // [m2] from the centre to its farther side
  };
  void find_steps(std::size_t axis, double centre, double reach);
  void fill(int x, int y, int from, int to) noexcept;

  int lateral_;
  double reach_;  // [m] beyond a placed sphere's surface
  std::array<bool, 2> periodic_{};
  std::array<scene::CellAxis, 2> axes_;
  scene::CellAxis vertical_;
  int rows_ = 0, height_ = 0;  // blocks along x, and along the vertical
  std::vector<std::uint64_t> blocks_;
  std::array<std::vector<Step>, 2> steps_;  // of add()
};

}  // namespace packmpi::rsa
