// The step kernels of one dimension for one instruction set. The build compiles this file once for each, with
//   PACKMPI_KERNEL     the namespace of all code in it, for example x86_64_v3_3d
//   PACKMPI_DIMENSION  2 or 3
// Nothing with external linkage is called, so the linker cannot mix the builds.
#include <utility>

#include "dynamics/kernel_motion.hpp"

namespace packmpi::dynamics::PACKMPI_KERNEL {

template <Features F>
struct Stepper {
  const StepData& data;
  Constants pair = constants_of(data.law, data.law.pair, data.time_step);
  Constants wall = constants_of(data.law, data.law.wall, data.time_step);
  Periods periods = periods_of(data);
  Motion motion = motion_of<F>(data);
  double scale = 1.0 / data.force_quantum;
  Tally tally{};
  Block<F> block;                                     // 30 KB, on the stack
  static constexpr LocalIndex finished_at_once = 64;  // few walls would not fill a block
  LocalIndex done;
  std::int64_t walls_done = 0;

  explicit PACKMPI_INLINE Stepper(const StepData& step_data)  // leaves the block as it is
      : data(step_data), done(step_data.begin) {}

  /// Walls and integration of all particles below `limit`, a ring's length at a time: beyond it walls would meet slots
  /// in use.
  PACKMPI_INLINE void finish(LocalIndex limit) {
    const auto ring = static_cast<LocalIndex>(data.ring_mask + 1);
    while (done < limit) {
      const LocalIndex to = limit - done > ring ? done + ring : limit;
      std::int64_t end = walls_done;
      while (end < data.walls && data.wall_particle[end] < to) ++end;
      add_walls<F>(data, wall, scale, block, tally, walls_done, end);
      walls_done = end;
      integrate<F>(data, motion, tally, done, to);
      done = to;
    }
  }

  PACKMPI_INLINE void run() {
    for (std::int64_t p = 0; p < data.pairs; p += block.taken) {
      const LocalIndex next = data.first[p];
      if (next - done >= finished_at_once) finish(next);
      take<F>(data, p, done, block);
      if (block.taken < block.size && done < next) {  // cut short, or the last one
        finish(next);
        take<F>(data, p, done, block);
      }
      sift<F>(data.records, periods, block);
      fetch<F>(data.stored_pairs, p, block);
      pack<F>(data.records, block);
      look_up<F>(data.law.pair_table, block);
      separate<F>(block, periods);
      resolve<F, Other::particle>(block, pair, scale);
      tally.pair_force.show(block.strength, block.filled);
      scatter<F>(data, block);
      keep<F>(block, data.stored_pairs, p);
    }
    finish(data.end);
    std::int64_t* dump = data.ring + (data.ring_mask + 1) * Memory<F>::accumulators;
    for (int a = 0; a < Memory<F>::accumulators; ++a) dump[a] = 0;
  }

  [[nodiscard]] PACKMPI_INLINE StepReport report() const {
    const Lanes v = tally.speed;
    const bool planar_spin = F.dimension == 2;  // lane 2 is then not a velocity
    const bool broken = (tally.broken[0] | tally.broken[1] | tally.broken[2]) != 0;
    const double square = v[0] * v[0] + v[1] * v[1] + (planar_spin ? 0.0 : v[2] * v[2]);
    const double limit = max_quanta * data.force_quantum;
    const auto holds = [&](const LawConstants& c, double force) {
      return force * (1.0 + c.friction + c.rolling_friction + c.twisting_friction) <= limit;  // false for NaN
    };
    const double pair_force = tally.pair_force.value();
    const double wall_force = tally.wall_force.value();
    const bool in_range = holds(data.law.pair, pair_force) && holds(data.law.wall, wall_force);
    const double both = pair_force + wall_force;
    const double most = pair_force < wall_force ? wall_force : pair_force;
    const double force = both - both == 0.0 ? most : __builtin_nan("");
    return {broken ? __builtin_nan("") : __builtin_sqrt(square), force, in_range};
  }
};

template <Features F>
static StepReport step(const StepData& data) {
  Stepper<F> stepper(data);
  stepper.run();
  return stepper.report();
}

/// The kernels there are, by number: which moving parts, each of which has more than the one before (nothing, friction,
/// rotation; or with memory friction, rotation, rolling), each periodic or not, graded or not. Then those of several
/// components, graded: without memory (friction is always in) at rest or with spin, and the three with memory, each
/// periodic or not. Drag is always in, its coefficient zero where the scene has none: a hundredth of a step at most.
constexpr int of_a_law = 12;
constexpr int one_component = 2 * of_a_law;
constexpr int kernel_count = one_component + 10;

constexpr Features mixed_features_of(int own) {
  Features f;
  f.dimension = PACKMPI_DIMENSION;
  const int moving = own / 2;
  f.memory = moving >= 2;
  f.rolling = moving == 4;
  f.rotation = moving == 1 || moving >= 3;
  f.friction = f.graded = f.mixture = true;
  f.periodic = own % 2 != 0;
  return f;
}

constexpr Features features_of(int number) {
  if (number >= one_component) return mixed_features_of(number - one_component);
  Features f;
  f.dimension = PACKMPI_DIMENSION;
  f.memory = number >= of_a_law;
  const int own = number % of_a_law;
  const int moving = own / 4;
  f.rolling = f.memory && moving == 2;
  f.rotation = moving >= (f.memory ? 1 : 2);
  f.friction = f.memory || moving >= 1;
  f.graded = (own & 1) != 0;
  f.periodic = (own & 2) != 0;
  f.near_field = false;
  return f;
}

template <class Numbers>
struct Table;
template <int... Number>
struct Table<std::integer_sequence<int, Number...>> {
  static constexpr Kernel kernels[] = {&step<features_of(Number)>...};
};
using Kernels = Table<std::make_integer_sequence<int, kernel_count>>;

Kernel kernel(const Features& f) {
  if (f.mixture) {
    const int moving = (f.memory ? 2 : 0) + (f.rotation ? 1 : 0) + (f.rolling ? 1 : 0);
    return Kernels::kernels[one_component + 2 * moving + (f.periodic ? 1 : 0)];
  }
  const int moving = f.memory ? (f.rolling ? 2 : (f.rotation ? 1 : 0))
                              : (f.rotation ? 2 : (f.friction ? 1 : 0));  // of spin with friction zero, too
  return Kernels::kernels[(f.memory ? of_a_law : 0) + 4 * moving + (f.periodic ? 2 : 0) + (f.graded ? 1 : 0)];
}

}  // namespace packmpi::dynamics::PACKMPI_KERNEL
