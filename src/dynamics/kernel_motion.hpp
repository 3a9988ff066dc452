/// Stages 4 and 5: walls and integration of the particles whose pairs are all done.
#pragma once
#include "dynamics/kernel_resolve.hpp"

namespace packmpi::dynamics::PACKMPI_KERNEL {

/// Normal, towards the wall, and distance of entry p of the block: of a round wall, geometry::RoundWall::facing.
template <Features F>
PACKMPI_INLINE void put_round(const geometry::RoundWall& wall, Block<F>& b, int p, const double* x) {
  double d[3] = {};
  for (int a = 0; a < F.dimension; ++a) d[a] = x[a] - wall.centre[static_cast<unsigned>(a)];
  double square = wall.weight[0] * (d[0] * d[0]) + wall.weight[1] * (d[1] * d[1]);
  double lean = wall.lean[0] * x[0] + wall.lean[1] * x[1];
  if constexpr (F.dimension == 3) {
    square = square + wall.weight[2] * (d[2] * d[2]);
    lean = lean + wall.lean[2] * x[2];
  }
  const double rho = root(square + geometry::RoundWall::tiny);
  const double inverse = 1.0 / rho;
  for (int a = 0; a < F.dimension; ++a) {
    const auto c = static_cast<unsigned>(a);
    b.in[a][p] = wall.radial * (wall.weight[c] * (d[a] * inverse)) + wall.lean[c];
  }
  b.distance[p] = wall.offset - wall.radial * rho - lean;
}

/// Fill entry p of the block for one particle at one wall: the wall is a second end whose fields are zero, but for its
/// speed along its axis.
template <Features F>
PACKMPI_INLINE void put_wall(const StepData& data, Block<F>& b, int p, std::int64_t entry) {
  const LocalIndex particle = data.wall_particle[entry];
  const neighbor::Wall wall = data.wall[entry];
  using M = Memory<F>;
  constexpr particles::Layout layout = F.layout();
  const double* record = data.records + std::int64_t{particle} * layout.stride;
  for (int a = 0; a < layout.stride; ++a) {
    b.in[a][p] = M::sign(a, false) != 0 ? -record[a] : record[a];
    if (M::reads(a) > 1) b.again[a][p] = M::sign(a, true) != 0 ? -record[a] : record[a];
  }
  const auto number = static_cast<unsigned>(wall);
  // Copies: the block that is written below cannot alias them.
  if (number >= geometry::most_planes) [[unlikely]] {
    if (number >= geometry::most_surfaces) {
      const geometry::Facing facing = data.facing[entry];
      for (unsigned a = 0; a < F.dimension; ++a) b.in[a][p] = facing.normal[a];
      b.distance[p] = facing.distance;
      return;
    }
    const geometry::RoundWall round = data.round[number - geometry::most_planes];
    put_round<F>(round, b, p, record);
    return;
  }
  const geometry::Plane plane = data.planes[number];
  for (int a = 0; a < F.dimension; ++a) b.in[a][p] = a == plane.axis ? plane.sign : 0.0;
  b.in[layout.velocity + plane.axis][p] = plane.speed - record[layout.velocity + plane.axis];
  b.distance[p] = plane.offset - plane.sign * record[plane.axis];
}

/// Contacts of the entries [from, to) of the wall list.
template <Features F>
PACKMPI_INLINE void add_walls(const StepData& data, const Constants& c, double scale, Block<F>& b, Tally& tally,
                              std::int64_t from, std::int64_t to) {
  using M = Memory<F>;
  while (from < to) {
    const int count = to - from < b.size ? static_cast<int>(to - from) : b.size;
    b.taken = b.count = count;
    b.filled = (count + 7) & ~7;
    for (int p = 0; p < b.filled; ++p) {
      b.entry[p] = p;
      put_wall<F>(data, b, p, from + (p < count ? p : count - 1));
    }
    look_up<F>(data.law.wall_table, b);
    fetch<F>(data.stored_walls, from, b);
    resolve<F, Other::wall>(b, c, scale);
    keep<F>(b, data.stored_walls, from);
    tally.wall_force.show(b.strength, b.filled);
    for (int p = 0; p < count; ++p) {
      std::int64_t* sum = data.ring + (data.wall_particle[from + p] & data.ring_mask) * M::accumulators;
      for (int a = 0; a < M::accumulators; ++a) {
        if (!M::given(a)) continue;
        // Wraps: a force out of range is garbage, not undefined.
        sum[a] =
            static_cast<std::int64_t>(static_cast<std::uint64_t>(sum[a]) + static_cast<std::uint64_t>(b.out[a][p]));
      }
    }
    from += count;
  }
}

/// What integration needs, by lane of the velocity vector (3D: v and the curvature; 2D: v, spin and padding).
struct Motion {
  Lanes inverse_mass;       // graded: to be multiplied by the particle's 1/m
  Lanes spin_inverse_mass;  // 3D
  Lanes gravity, drag, fluid_velocity;
  Lanes step, spin_step;       // dt in the lanes that move, else 0
  Lanes lower, upper, period;  // periodic wrap of the position vector
  Lanes quantum;
  double mass_factor;
};

template <Features F>
PACKMPI_INLINE Motion motion_of(const StepData& data) {
  const bool deep = F.dimension == 3;
  const double mass = F.graded ? 1.0 : 1.0 / data.law.wall.reduced_mass;
  const double spin = 2.5 * mass;  // j = 2/5 m r^2
  const double dt = data.time_step;
  const double inf = __builtin_inf();
  const bool px = data.periodic[0];
  const bool py = deep && data.periodic[1];
  Motion m{};
  m.inverse_mass = Lanes{mass, mass, deep ? mass : spin, 0.0};
  m.spin_inverse_mass = Lanes{spin, spin, spin, 0.0};
  m.gravity = Lanes{data.gravity[0], data.gravity[1], deep ? data.gravity[2] : 0.0, 0.0};
  m.drag = Lanes{data.drag, data.drag, deep ? data.drag : 0.0, 0.0};
  m.fluid_velocity = Lanes{data.fluid_velocity[0], data.fluid_velocity[1], deep ? data.fluid_velocity[2] : 0.0, 0.0};
  m.step = Lanes{dt, dt, deep ? dt : 0.0, 0.0};
  m.spin_step = Lanes{dt, dt, dt, 0.0};
  m.lower = Lanes{px ? 0.0 : -inf, py ? 0.0 : -inf, -inf, -inf};
  m.upper = Lanes{px ? data.size[0] : inf, py ? data.size[1] : inf, inf, inf};
  m.period = Lanes{px ? data.size[0] : 0.0, py ? data.size[1] : 0.0, 0.0, 0.0};
  m.quantum = spread(data.force_quantum);
  m.mass_factor = data.law.mass_factor;
  return m;
}

/// Advance one particle and clear its accumulators. Lanes that hold no state are written back as they were read.
template <Features F>
PACKMPI_INLINE void advance(double* record, std::int64_t* sum, const Motion& m, Tally& tally) {
  constexpr particles::Layout layout = F.layout();
  constexpr bool half = F.dimension == 2 && !F.rotation;  // two lanes of velocity, and behind them the next record
  Lanes x = load(record);
  Lanes v = half ? load_half(record + 4) : load(record + 4);
  double mass = 1.0;
  if constexpr (F.graded) {
    const double k = F.dimension == 3 ? v[3] : x[3];
    mass = m.mass_factor * k * k * k;
    if constexpr (F.mixture) mass = record[layout.component + 1];
  }
  Lanes force = __builtin_convertvector(reinterpret_cast<IntLanes>(load_bits(sum)), Lanes) * m.quantum;
  store_bits(sum, BitLanes{});
  force = force - m.drag * (v - m.fluid_velocity);
  v = v + m.spin_step * (force * (m.inverse_mass * mass) + m.gravity);
  const Lanes moved = x + m.step * v;
  x = __builtin_shufflevector(moved, x, 0, 1, F.dimension == 3 ? 2 : 6, 7);
  if constexpr (F.periodic) {
    x = x < m.lower ? x + m.period : x;
    x = x >= m.upper ? x - m.period : x;
  }
  store(record, x);
  if constexpr (half) store_half(record + 4, v);
  if constexpr (!half) store(record + 4, v);
  const Lanes speed = magnitude(v);
  tally.speed = speed > tally.speed ? speed : tally.speed;
  tally.broken |= as_bits(x - x) | as_bits(v - v);
  if constexpr (F.dimension == 3 && F.rotation) {
    Lanes s = load(record + 8);
    const Lanes moment = __builtin_convertvector(reinterpret_cast<IntLanes>(load_bits(sum + 4)), Lanes) * m.quantum;
    store_bits(sum + 4, BitLanes{});
    s = s + m.spin_step * (moment * (m.spin_inverse_mass * mass));
    store(record + 8, s);
    tally.broken |= as_bits(s - s);
  }
}

/// All particles of [from, to): nobody needs their old state any more.
template <Features F>
PACKMPI_INLINE void integrate(const StepData& data, const Motion& m, Tally& tally, LocalIndex from, LocalIndex to) {
  constexpr int accumulators = Memory<F>::accumulators;
  Tally mine = tally;
  for (std::int64_t i = from; i < to; ++i) {
    advance<F>(data.records + i * Memory<F>::stride, data.ring + (i & data.ring_mask) * accumulators, m, mine);
  }
  tally = mine;
}

}  // namespace packmpi::dynamics::PACKMPI_KERNEL
