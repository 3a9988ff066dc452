/// A block of pairs in three stages: records to structure-of-arrays, the law over all, integers back to the
/// accumulators.
#pragma once
#include "dynamics/kernel.hpp"
#include "dynamics/kernel_contact.hpp"

namespace packmpi::dynamics::PACKMPI_KERNEL {

/// What the state of a particle is in memory, for the kernel's template arguments.
template <Features F>
struct Memory {
  static constexpr particles::Layout layout = F.layout();
  static constexpr int stride = layout.stride;
  static constexpr int chunks = layout.dimension == 3 && layout.rotation ? 3 : 2;  // vectors of four a record
  static constexpr int accumulators = accumulators_of(layout);
  static constexpr int forces = F.dimension == 2 && F.rotation ? 3 : F.dimension;  // in 2D the moment is the third
  static constexpr int moments = accumulators == 8 ? 3 : 0;                        // from the fifth

  /// Is this offset of a record subtracted (position, velocity) when a pair is formed, or added (radius, spin, ...)?
  static constexpr bool differs(int offset) {
    return (offset >= layout.position && offset < layout.position + layout.dimension) ||
           (offset >= layout.velocity && offset < layout.velocity + layout.dimension);
  }
  /// Flips the sign of the first's fields that are subtracted.
  static PACKMPI_INLINE BitLanes signs(int chunk) {
    return BitLanes{sign(4 * chunk), sign(4 * chunk + 1), sign(4 * chunk + 2), sign(4 * chunk + 3)};
  }
  static constexpr std::uint64_t sign(int offset) { return differs(offset) ? 0x8000000000000000U : 0U; }
};

/// Pairs (or wall contacts) in flight. Rows of `place` and then of `in` are the fields of a record, differences or sums
/// over the pair; rows of `out` are accumulators.
struct Block {
  static constexpr int size = 128;
  static constexpr int row = size + 8;        // rows a power of two apart would share cache sets
  static constexpr int places = 4;            // fields in `place`
  alignas(64) double place[places + 1][row];  // the last: the distance of a wall
  alignas(64) double in[8][row];              // from field number `places` on
  alignas(64) std::int64_t out[8][row];
  alignas(64) double strength[size];
  alignas(64) LocalIndex first[size];  // slots of records; filled up to a multiple of 8 with the last pair
  alignas(64) LocalIndex second[size];
  alignas(64) LocalIndex first_slot[size];  // slots of accumulators; the fill and ghosts go to the dump
  alignas(64) LocalIndex second_slot[size];
  int count;         // pairs
  int filled;        // count rounded up to 8
  LocalIndex reach;  // largest second - first pair's first, of owned ends
};

/// What must be true of the whole step: the extremes over all contacts and particles, and a sticky trace of NaN.
struct Tally {
  Lanes speed{};            // largest |v| of each lane
  BitLanes broken{};        // nonzero once a state was not finite
  double pair_force = 0.0;  // largest normal force
  double wall_force = 0.0;
};

/// The largest of `count` (a multiple of 4) numbers and `so_far`; NaN if one of them is not finite.
PACKMPI_INLINE double largest(const double* x, int count, double so_far) {
  Lanes most = spread(so_far);
  BitLanes broken = {};
  for (int p = 0; p < count; p += 4) {
    const Lanes a = load(x + p);
    most = a > most ? a : most;
    broken |= as_bits(a - a);
  }
  double m = so_far;
  for (int lane = 0; lane < 4; ++lane) m = most[lane] > m ? most[lane] : m;
  if ((broken[0] | broken[1] | broken[2] | broken[3]) != 0 || so_far - so_far != 0.0) m = __builtin_nan("");
  return m;
}

/// Take up to a block of pairs, as many as the ring holds above `base`, the lowest slot in use.
PACKMPI_INLINE void take(const StepData& data, std::int64_t pair, LocalIndex base, Block& b) {
  const std::int64_t left = data.pairs - pair;
  const int wanted = left < b.size ? static_cast<int>(left) : b.size;
  const LocalIndex* first = data.first + pair;
  const LocalIndex* second = data.second + pair;
  const auto mask = static_cast<LocalIndex>(data.ring_mask);
  const LocalIndex dump = mask + 1;
  LocalIndex reach = 0;
  for (int p = 0; p < wanted; ++p) {
    const LocalIndex i = first[p];
    const LocalIndex j = second[p];
    const bool owned = j < data.owned;
    const LocalIndex ahead = (owned ? j : i) - base;
    reach = ahead > reach ? ahead : reach;
    b.first[p] = i;
    b.second[p] = j;
    b.first_slot[p] = i & mask;
    b.second_slot[p] = owned ? j & mask : dump;
  }
  b.count = wanted;
  b.reach = reach;
  if (reach > mask) {  // rare: the ring is little larger than the window
    b.count = 0;
    const auto last = [&](int p) { return second[p] < data.owned ? second[p] : first[p]; };
    while (last(b.count) - base <= mask) ++b.count;
  }
  b.filled = (b.count + 7) & ~7;
  for (int p = b.count; p < b.filled; ++p) {
    b.first[p] = b.first[b.count - 1];
    b.second[p] = b.second[b.count - 1];
    b.first_slot[p] = dump;
    b.second_slot[p] = dump;
  }
}

/// Stage 1: records of both ends, differences and sums, transposed.
template <Features F>
PACKMPI_INLINE void pack(const double* records, Block& b) {
  using M = Memory<F>;
  constexpr int stride = M::stride;
  const std::int64_t ahead = b.reach + 80;  // records that the next blocks will be the first to touch
  for (int p = 0; p < b.filled; p += 4) {
    const double* i[4];
    const double* j[4];
    for (int e = 0; e < 4; ++e) {
      i[e] = records + std::int64_t{b.first[p + e]} * stride;
      j[e] = records + std::int64_t{b.second[p + e]} * stride;
    }
    __builtin_prefetch(i[0] + ahead * stride);  // a record spans two lines
    __builtin_prefetch(i[0] + ahead * stride + 8);
    for (int chunk = 0; chunk < M::chunks; ++chunk) {
      const BitLanes sign = M::signs(chunk);
      Lanes pair[4];
      for (int e = 0; e < 4; ++e) {
        pair[e] = load(j[e] + 4 * chunk) + as_doubles(as_bits(load(i[e] + 4 * chunk)) ^ sign);
      }
      transpose(pair[0], pair[1], pair[2], pair[3]);
      for (int e = 0; e < 4; ++e) {
        if (chunk == 0) store(b.place[e] + p, pair[e]);
        if (chunk > 0) store(b.in[4 * (chunk - 1) + e] + p, pair[e]);
      }
    }
  }
}

/// Stage 3: integers back to one vector a pair, added to the accumulators of the first, and of the second with the
/// reaction: forces change sign, moments do not.
template <Features F>
PACKMPI_INLINE void scatter(std::int64_t* ring, Block& b) {
  constexpr int accumulators = Memory<F>::accumulators;
  constexpr int forces = Memory<F>::forces;
  constexpr int moments = Memory<F>::moments;
  constexpr std::uint64_t minus = 0xffffffffffffffff;
  constexpr BitLanes flip = {minus, minus, F.dimension == 3 ? minus : 0, 0};
  for (int p = 0; p < b.filled; p += 4) {
    BitLanes force[4];
    BitLanes moment[4];
    for (int e = 0; e < 4; ++e) {
      force[e] = e < forces ? load_bits(b.out[e] + p) : BitLanes{};
      moment[e] = e < moments ? load_bits(b.out[4 + e] + p) : BitLanes{};
    }
    transpose(force[0], force[1], force[2], force[3]);
    if constexpr (moments > 0) transpose(moment[0], moment[1], moment[2], moment[3]);
    for (int e = 0; e < 4; ++e) {
      std::int64_t* i = ring + std::int64_t{b.first_slot[p + e]} * accumulators;
      std::int64_t* j = ring + std::int64_t{b.second_slot[p + e]} * accumulators;
      store_bits(i, load_bits(i) + force[e]);
      store_bits(j, load_bits(j) + ((force[e] ^ flip) - flip));
      if constexpr (moments > 0) {
        store_bits(i + 4, load_bits(i + 4) + moment[e]);
        store_bits(j + 4, load_bits(j + 4) + moment[e]);
      }
    }
  }
}

}  // namespace packmpi::dynamics::PACKMPI_KERNEL
