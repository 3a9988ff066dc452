/// A block of pairs in three stages: records to structure-of-arrays, the law over all, integers back to the
/// accumulators.
#pragma once
#include "dynamics/kernel.hpp"
#include "dynamics/kernel_contact.hpp"

namespace packmpi::dynamics::PACKMPI_KERNEL {

/// What a record, a pair and a contact's store are in memory, for the kernel's template arguments: see
/// scene/pair_channels.hpp.
template <Features F>
struct Memory {
  static constexpr particles::Layout layout = F.layout();
  static constexpr int stride = layout.stride;
  static constexpr int chunks =  // of four fields a record
      (layout.dimension == 3 && layout.rotation ? 3 : 2) + (F.mixture ? 1 : 0);
  static constexpr int rows = 4 * chunks;
  static constexpr int stored = scene::stored_doubles(F);
  static constexpr int accumulators = accumulators_of(layout);
  static constexpr bool two_loops = F.memory && F.dimension == 3;  // of the law, see kernel_resolve.hpp

  /// How often a field at this offset is read.
  static constexpr int reads(int offset) {
    int count = 0;
    for (const scene::Reading& row : scene::readings(F)) count += covers(row, offset) ? 1 : 0;
    return count;
  }
  /// Is any of the fields of a square from `offset` on read twice?
  static constexpr bool twice(int offset) {
    bool any = false;
    for (int lane = 0; lane < width; ++lane) any = any || reads(offset + lane) > 1;
    return any;
  }
  static constexpr bool any_twice = [] {
    bool any = false;
    for (int field = 0; field < rows; ++field) any = any || reads(field) > 1;
    return any;
  }();

  /// Flips the sign of the first's fields that are subtracted in the first reading, or of those that were not, in the
  /// second.
  static PACKMPI_INLINE BitRow signs(int offset, bool second) {
    return row_of([&](int lane) { return sign(offset + lane, second); });
  }
  static constexpr std::uint64_t sign(int offset, bool second) {
    bool differs = false;
    for (const scene::Reading& row : scene::readings(F)) {
      if (!covers(row, offset)) continue;
      differs = row.combine == scene::Combine::difference;
      if (!second) break;
    }
    return differs ? 0x8000000000000000U : 0U;
  }

  /// Is accumulator `number` given to the other end as it is, negated, or by a number of its own; or not at all?
  static constexpr bool given(int number, scene::Mirror mirror) {
    bool any = false;
    for (const scene::Giving& row : scene::givings(F)) {
      any = any || (row.mirror == mirror && number >= row.accumulator && number < row.accumulator + row.components);
    }
    return any;
  }
  static constexpr bool given(int number) {
    return given(number, scene::Mirror::same) || given(number, scene::Mirror::opposite) ||
           given(number, scene::Mirror::own);
  }
  static constexpr bool any_own = [] {
    bool any = false;
    for (const scene::Giving& row : scene::givings(F)) any = any || row.mirror == scene::Mirror::own;
    return any;
  }();
  static constexpr std::uint64_t minus(int number) {
    return given(number, scene::Mirror::opposite) ? 0xffffffffffffffffU : 0U;
  }

 private:
  static constexpr bool covers(const scene::Reading& row, int offset) {
    return offset >= row.offset && offset < row.offset + row.components;
  }
};

/// Constants of the law that differ from pair to pair of components, in the order of Constants.
constexpr int pair_constants = 7;

/// Pairs (or wall contacts) in flight. Rows of `in` are the fields of a record, combined over the pair; of `again`,
/// those that are read a second time; of `out`, accumulators of the first; of `own`, those of the second that are not
/// the first's; of `stored`, what the contact keeps.
template <Features F>
struct Block {
  using M = Memory<F>;
  // What a block touches has to stay in 32 KB of cache.
  static constexpr int size = F.rolling ? 32 : (F.memory ? 64 : 128);
  static constexpr int row = size + 8;  // rows a power of two apart would share cache sets
  alignas(64) double in[M::rows][row];
  alignas(64) double again[M::any_twice ? M::rows : 1][row];
  alignas(64) double distance[row];  // of a wall
  alignas(64) double pressed[M::two_loops ? 4 : 1][row];
  alignas(64) std::int64_t out[M::accumulators][row];
  alignas(64) std::int64_t own[M::any_own ? M::accumulators : 1][row];
  alignas(64) double stored[M::stored > 0 ? M::stored : 1][row];
  alignas(64) double law[F.mixture ? pair_constants : 1][row];  // of several components: the pair's own constants
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
template <Features F>
PACKMPI_INLINE void take(const StepData& data, std::int64_t pair, LocalIndex base, Block<F>& b) {
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

/// What `count` contacts have stored, from entry `at` of a list on, into the rows; zero in the fill. The block after
/// the next is fetched from memory meanwhile.
template <Features F>
PACKMPI_INLINE void fetch(const StoredVectors& from, std::int64_t at, Block<F>& b) {
  constexpr int line = 8, ahead = 2 * Block<F>::size;
  for (int c = 0; c < Memory<F>::stored; ++c) {
    const double* source = from.values + c * from.entries + at;
    for (int p = 0; p < Block<F>::size; p += line) __builtin_prefetch(source + ahead + p, 1);
    for (int p = 0; p < b.count; ++p) b.stored[c][p] = source[p];
    for (int p = b.count; p < b.filled; ++p) b.stored[c][p] = 0.0;
  }
}

/// And back.
template <Features F>
PACKMPI_INLINE void keep(const Block<F>& b, const StoredVectors& to, std::int64_t at) {
  for (int c = 0; c < Memory<F>::stored; ++c) {
    double* target = to.values + c * to.entries + at;
    for (int p = 0; p < b.count; ++p) target[p] = b.stored[c][p];
  }
}

/// With several components: the constants of each pair (or wall contact) from the table of its kind, by the code that
/// the ends add up to.
template <Features F>
PACKMPI_INLINE void look_up(const LawConstants* table, Block<F>& b) {
  if constexpr (F.mixture) {
    for (int p = 0; p < b.filled; ++p) {
      const LawConstants& c = table[static_cast<int>(b.in[F.layout().component][p])];
      b.law[0][p] = c.stiffness, b.law[1][p] = c.damping, b.law[2][p] = c.friction;
      b.law[3][p] = c.shear_stiffness, b.law[4][p] = c.shear_damping;
      b.law[5][p] = c.rolling_friction, b.law[6][p] = c.twisting_friction;
    }
  }
}

/// Stage 1: records of both ends, differences and sums, transposed.
template <Features F>
PACKMPI_INLINE void pack(const double* records, Block<F>& b) {
  using M = Memory<F>;
  constexpr int stride = M::stride;
  const std::int64_t ahead = b.reach + 80;  // records that the next blocks will be the first to touch
  for (int p = 0; p < b.filled; p += width) {
    const double* i[width];
    const double* j[width];
    for (int e = 0; e < width; ++e) {
      i[e] = records + std::int64_t{b.first[p + e]} * stride;
      j[e] = records + std::int64_t{b.second[p + e]} * stride;
    }
    if (p % 4 == 0) {
      __builtin_prefetch(i[0] + ahead * stride);  // a record spans two lines
      __builtin_prefetch(i[0] + ahead * stride + 8);
    }
    for (int field = 0; field < M::rows; field += width) {
      for (const bool second : {false, true}) {
        if (second && !M::twice(field)) continue;
        const BitRow signs = M::signs(field, second);
        Row pair[width];
        for (int e = 0; e < width; ++e) pair[e] = load_row(j[e] + field) + flipped(load_row(i[e] + field), signs);
        transpose(pair);
        for (int e = 0; e < width; ++e) store_row((second ? b.again : b.in)[field + e] + p, pair[e]);
      }
    }
  }
}

/// Stage 3: integers back to one vector a pair, added to the accumulators of the first, and of the second what is the
/// same, negated or its own.
template <Features F>
PACKMPI_INLINE void scatter(std::int64_t* ring, Block<F>& b) {
  using M = Memory<F>;
  constexpr int accumulators = M::accumulators;
  for (int p = 0; p < b.filled; p += width) {
    for (int a = 0; a < accumulators; a += width) {
      const BitRow flip = row_of([&](int e) { return M::minus(a + e); });
      BitRow given[width];
      BitRow taken[width];
      for (int e = 0; e < width; ++e) given[e] = M::given(a + e) ? load_row(b.out[a + e] + p) : BitRow{};
      if constexpr (M::any_own) {
        for (int e = 0; e < width; ++e) {  // what is not its own is negated below
          taken[e] = M::given(a + e, scene::Mirror::own) ? load_row(b.own[a + e] + p) : given[e];
        }
        transpose(taken);
      }
      transpose(given);
      for (int e = 0; e < width; ++e) {
        std::int64_t* i = ring + std::int64_t{b.first_slot[p + e]} * accumulators + a;
        std::int64_t* j = ring + std::int64_t{b.second_slot[p + e]} * accumulators + a;
        store_row(i, load_row(i) + given[e]);
        store_row(j, load_row(j) + (((M::any_own ? taken[e] : given[e]) ^ flip) - flip));
      }
    }
  }
}

}  // namespace packmpi::dynamics::PACKMPI_KERNEL
