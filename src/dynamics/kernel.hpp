/// One explicit step of all owned particles, fused: contact forces in blocks of pairs, walls, integration in place.
///
/// Forces are summed as 64-bit integers in units of the scene's force quantum, so the result does not depend on the
/// order of pairs, the memory order, the skin, the last rebuild or the ranks. Compiled three times (baseline x86-64,
/// v3, v4), the best is chosen when the program starts: same bits, IEEE operations only, no contraction.
#pragma once
#include <array>
#include <bit>
#include <cstdint>

#include "dynamics/law.hpp"
#include "neighbor/lists.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::dynamics {

/// int64 accumulators of a particle: 3D rotation {fx fy fz - qx qy qz -}, 3D {fx fy fz -}, 2D {fx fy q -};
/// q = sum of n x f_t, so that d(r omega)/dt = 5/2 q / m.
[[nodiscard]] constexpr int accumulators_of(const particles::Layout& layout) {
  return layout.dimension == 3 && layout.rotation ? 8 : 4;
}

/// What the contacts of a list have stored (scene::storings): double c of entry p at values[c * entries + p]. A step
/// replaces it. Null where the law stores nothing.
struct StoredVectors {
  double* values = nullptr;
  std::int64_t entries = 0;
};

/// The walls of a container by their numbers; of those that it has not, too.
using Planes = std::array<geometry::Plane, geometry::most_planes>;
[[nodiscard]] constexpr Planes planes_of(const geometry::Container& container) {
  Planes planes{};
  for (std::size_t number = 0; number < planes.size(); ++number) {
    planes[number] = container.plane(static_cast<geometry::Surface>(number));
  }
  return planes;
}
/// The same of its round walls.
[[nodiscard]] inline geometry::RoundWalls round_of(const geometry::Container& container) {
  geometry::RoundWalls walls{};
  for (std::size_t k = 0; k < walls.size() && !container.is_box(); ++k) walls[k] = container.round(k);
  return walls;
}

/// Everything a kernel reads and writes. Pointers are not owned. A step may be done in several calls, one for each part
/// of the slots in ascending order: the lists are then those of the part, and the ring is left alone between the calls.
struct StepData {
  double* records;  ///< Store::records(); the owned are advanced in place, ghosts only read
  LocalIndex owned;
  LocalIndex begin, end;    ///< slots of this call: all pairs whose first is one of them, all walls of them
  const LocalIndex* first;  ///< pair list, see neighbor::PairList
  const LocalIndex* second;
  std::int64_t pairs;
  const LocalIndex* wall_particle;  ///< wall list, see neighbor::WallList
  const neighbor::Wall* wall;
  std::int64_t walls;
  std::int64_t* ring;  ///< accumulators of slot i at ring[(i & ring_mask) * accumulators_of(layout)];
                       ///< zero (or prefilled, near field) before a step, zero after it. 64-byte aligned.
  /// Slots - 1; slots a power of two >= window (see ring_slots), or >= owned when prefilled. One more slot follows
  /// them: a dump for what ghosts would get.
  std::int64_t ring_mask;
  Law law;
  double force_quantum;  ///< [N], power of two
  double time_step;      ///< [s]
  Vec3 gravity;          ///< [m/s2]
  double drag;           ///< [N s/m]
  Vec3 fluid_velocity;   ///< [m/s]
  Vec3 size;             ///< [m] container; the period on periodic axes
  std::array<bool, 2> periodic;
  Planes planes;
  geometry::RoundWalls round = {};
  const geometry::Facing* facing = nullptr;  ///< of a mesh: of the entries from `wall_particle` on
  StoredVectors stored_pairs = {};           ///< of the entries from `first` on
  StoredVectors stored_walls = {};           ///< of the entries from `wall_particle` on
};

/// Slots of a ring for a pair list's window. The room beyond it lets a block of pairs run on while the slots of its
/// first particles are still in use; with less the kernel is right but cuts its blocks short.
[[nodiscard]] constexpr std::int64_t ring_slots(LocalIndex window) {
  return static_cast<std::int64_t>(std::bit_ceil(static_cast<std::uint64_t>(window) + 128));
}

/// What a step tells.
struct StepReport {
  /// [m/s] an upper bound (within sqrt(3)) of the largest speed after the step; NaN or inf if any state is not finite
  double max_speed = 0.0;
  double max_force = 0.0;  ///< [N] the largest normal force of a contact; NaN if one is not finite
  bool in_range = true;    ///< false: a force left the range of the integer sums, the state is garbage
};

/// What a step tells that was done in two parts.
[[nodiscard]] StepReport together(const StepReport& a, const StepReport& b);

/// A kernel for the features; the pointer stays valid for ever. Local.
using Kernel = StepReport (*)(const StepData&);
[[nodiscard]] Kernel select_kernel(const scene::Features& features);

/// The instruction set chosen: "x86-64", "x86-64-v3" or "x86-64-v4". PACKMPI_ARCH=... in the environment lowers it
/// (tests).
[[nodiscard]] const char* kernel_architecture();

/// Largest force the integer sums take from one contact, in quanta: 2^50. (The conversion adds 1.5 * 2^52.)
inline constexpr double max_quanta = 1125899906842624.0;

}  // namespace packmpi::dynamics
