/// A block of pairs: those that touch, in three stages. Records to structure-of-arrays, the law over all, integers back
/// to the accumulators.
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
    return row_of<BitRow>([&](int lane) { return sign(offset + lane, second); });
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
  // What a block touches has to stay in 32 KB of cache. Two of three entries that are taken touch.
  static constexpr int size = F.rolling ? 64 : (F.memory ? 96 : 128);
  static constexpr int row = size + 8;  // rows a power of two apart would share cache sets
  alignas(64) double in[M::rows][row];
  alignas(64) double again[M::any_twice ? M::rows : 1][row];
  alignas(64) double distance[row];             // of the centres, or of one from a wall
  alignas(64) double bend[F.memory ? row : 1];  // of pairs, 1 / distance
  alignas(64) double pressed[M::two_loops ? 4 : 1][row];
  alignas(64) std::int64_t out[M::accumulators][row];
  alignas(64) std::int64_t own[M::any_own ? M::accumulators : 1][row];
  alignas(64) double stored[M::stored > 0 ? M::stored : 1][row];
  alignas(64) double law[F.mixture ? pair_constants : 1][row];  // of several components: the pair's own constants
  alignas(64) double strength[size];
  // Of the list's entries that were taken, and of a square of those that count for nothing:
  alignas(64) LocalIndex first[size + 8];  // slots of records
  alignas(64) LocalIndex second[size + 8];
  alignas(64) LocalIndex first_slot[size + 8];  // slots of accumulators; what ghosts would get goes to the dump
  alignas(64) LocalIndex second_slot[size + 8];
  alignas(64) std::int64_t apart[size];  // not zero: these do not touch
  alignas(64) int entry[size];           // which of them the pairs of the block are
  int taken;                             // how many they are
  int count;                             // pairs of the block
  int filled;                            // count rounded up to 8 by entries that count for nothing
  LocalIndex reach;                      // largest second, of owned ends, less the first of the first entry
};

/// Periods for the shortest image; an axis with walls has one too large to matter.
struct Periods {
  double period[2], half[2];
};

PACKMPI_INLINE Periods periods_of(const StepData& data) {
  Periods p{};
  for (unsigned axis = 0; axis < 2; ++axis) {
    p.period[axis] = data.periodic[axis] ? data.size[axis] : 0.0;
    p.half[axis] = data.periodic[axis] ? 0.5 * data.size[axis] : __builtin_inf();
  }
  return p;
}

/// geometry::shortest, with the half period at hand; of numbers or of lanes.
template <class Number>
PACKMPI_INLINE Number shortest(Number d, Number period, Number half) {
  d = d > half ? d - period : d;
  return d < -half ? d + period : d;
}

/// Of a pair's fields from `field` on, the part of (distance squared) - (sum of the radii squared) that lies in each
/// lane; larger than zero only if the pair is apart by more than rounding.
template <Features F>
PACKMPI_INLINE Row weighed(Row pair, const Periods& periods, int field) {
  constexpr double safely = 1.0 + 1e-12;
  if constexpr (F.periodic) {
    const auto lanes = [&](const double(&of)[2], double other) {
      return row_of<Row>([&](int e) { return field + e < F.dimension - 1 ? of[field + e] : other; });
    };
    const Row period = lanes(periods.period, 0.0), half = lanes(periods.half, __builtin_inf());
    pair = shortest(pair, period, half);
  }
  const Row weight =
      row_of<Row>([&](int e) { return field + e < F.dimension ? 1.0 : (field + e == F.dimension ? -safely : 0.0); });
  return pair * pair * weight;
}

/// The largest of what it was shown, and a sticky trace of what was not finite.
struct Largest {
  Lanes most{};
  BitLanes broken{};

  /// `count` numbers, a multiple of 8.
  PACKMPI_INLINE void show(const double* x, int count) {
    Lanes even = most;
    Lanes odd = {};
    BitLanes bits = broken;
    for (int p = 0; p < count; p += 8) {
      const Lanes a = load(x + p);
      const Lanes b = load(x + p + 4);
      even = a > even ? a : even;
      odd = b > odd ? b : odd;
      bits |= as_bits(a - a) | as_bits(b - b);
    }
    most = odd > even ? odd : even;
    broken = bits;
  }
  /// NaN if one of them was not finite.
  [[nodiscard]] PACKMPI_INLINE double value() const {
    double m = 0.0;
    for (int lane = 0; lane < 4; ++lane) m = most[lane] > m ? most[lane] : m;
    return (broken[0] | broken[1] | broken[2] | broken[3]) != 0 ? __builtin_nan("") : m;
  }
};

/// What must be true of the whole step: the extremes over all contacts and particles.
struct Tally {
  Lanes speed{};       // largest |v| of each lane
  BitLanes broken{};   // nonzero once a state was not finite
  Largest pair_force;  // normal forces
  Largest wall_force;
};

/// Take up to a block of pairs, as many as the ring holds above `base`, the lowest slot in use.
template <Features F>
PACKMPI_INLINE void take(const StepData& data, std::int64_t pair, LocalIndex base, Block<F>& b) {
  const std::int64_t left = data.pairs - pair;
  const int wanted = left < b.size ? static_cast<int>(left) : b.size;
  const LocalIndex* first = data.first + pair;
  const LocalIndex* second = data.second + pair;
  const auto mask = static_cast<LocalIndex>(data.ring_mask);
  const LocalIndex dump = mask + 1;
  const LocalIndex owned = data.owned;
  LocalIndex last = first[wanted - 1];
#pragma GCC ivdep
  for (int p = 0; p < wanted; ++p) {
    const LocalIndex i = first[p];
    const LocalIndex j = second[p];
    const LocalIndex ghost = (owned - 1 - j) >> 31;  // all bits or none; conditions would become jumps
    const LocalIndex end = (j & ~ghost) | (i & ghost);
    last = end > last ? end : last;
    b.first[p] = i;
    b.second[p] = j;
    b.first_slot[p] = i & mask;
    b.second_slot[p] = (j & mask & ~ghost) | (dump & ghost);
  }
  b.taken = wanted;
  b.reach = last - first[0];
  if (last - base > mask) {  // rare: the ring is little larger than the window
    b.taken = 0;
    const auto end = [&](int p) { return second[p] < owned ? second[p] : first[p]; };
    while (end(b.taken) - base <= mask) ++b.taken;
  }
  for (int p = b.taken; p < b.taken + width; ++p) {
    b.first[p] = first[0];
    b.second[p] = second[0];
    b.first_slot[p] = b.second_slot[p] = dump;
  }
}

/// A record that the next blocks will be the first to touch, seen from a first one of this block.
template <Features F>
PACKMPI_INLINE void prefetch(const double* first, const Block<F>& b) {
  const double* later = first + std::int64_t{b.reach + 80} * Memory<F>::stride;
  __builtin_prefetch(later);  // it spans two lines
  __builtin_prefetch(later + 8);
}

/// Leaves out pairs that do not touch, which would get zeros: in a bed every third that is listed because it lies
/// within a skin. What is left out is farther apart than rounding makes up for; a pair without a finite distance stays.
/// A law that acts at a distance has to reach as far here.
template <Features F>
PACKMPI_INLINE void sift(const double* records, const Periods& periods, Block<F>& b) {
  constexpr int stride = Memory<F>::stride;
  constexpr int radius = F.layout().radius;
  static_assert(F.layout().position == 0 && radius == F.dimension && radius < 4);
  for (int p = 0; p < b.taken; p += width) {
    if (p % 4 == 0) prefetch<F>(records + std::int64_t{b.first[p]} * stride, b);
    Row square = {};
    for (int field = 0; field < 4; field += width) {
      Row pair[width];
      for (int e = 0; e < width; ++e) {
        const Row i = load_row(records + std::int64_t{b.first[p + e]} * stride + field);
        const Row j = load_row(records + std::int64_t{b.second[p + e]} * stride + field);
        pair[e] = weighed<F>(j + flipped(i, Memory<F>::signs(field, false)), periods, field);
      }
      square = square + sums(pair);
    }
    store_row(b.apart + p, reinterpret_cast<BitRow>((square > Row{}) & (square < Row{} + __builtin_inf())));
  }
  const int taken = b.taken;  // locals: the loop cannot change them
  const std::int64_t* apart = b.apart;
  int* entry = b.entry;
  for (int p = 0; p < taken; ++p) {
    *entry = p;
    entry += apart[p] == 0 ? 1 : 0;
  }
  const auto touching = static_cast<int>(entry - b.entry);
  b.count = touching;
  b.filled = (touching + 7) & ~7;
  for (int p = touching; p < b.filled; ++p) b.entry[p] = taken;
}

/// What the contacts have stored, from entry `at` of a list on, into the rows; zero in the fill. The block after the
/// next is fetched from memory meanwhile.
template <Features F>
PACKMPI_INLINE void fetch(const StoredVectors& from, std::int64_t at, Block<F>& b) {
  constexpr int line = 8, ahead = 2 * Block<F>::size;
  for (int c = 0; c < Memory<F>::stored; ++c) {
    const double* source = from.values + c * from.entries + at;
    for (int p = 0; p < Block<F>::size; p += line) __builtin_prefetch(source + ahead + p, 1);
    for (int p = 0; p < b.count; ++p) b.stored[c][p] = source[b.entry[p]];
    for (int p = b.count; p < b.filled; ++p) b.stored[c][p] = 0.0;
  }
}

/// And back; zero to entries that are not in the block.
template <Features F>
PACKMPI_INLINE void keep(const Block<F>& b, const StoredVectors& to, std::int64_t at) {
  for (int c = 0; c < Memory<F>::stored; ++c) {
    double* target = to.values + c * to.entries + at;
    if (b.count < b.taken) {
      for (int p = 0; p < b.taken; ++p) target[p] = 0.0;
    }
    for (int p = 0; p < b.count; ++p) target[b.entry[p]] = b.stored[c][p];
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

/// Of pairs p .. p + width - 1, whose records are given, the fields of one square, in their first or second reading.
template <Features F, int field, bool second>
PACKMPI_INLINE void put_square(double (*rows)[Block<F>::row], int p, const double* const* i, const double* const* j) {
  const BitRow signs = Memory<F>::signs(field, second);
  Row pair[width];
  for (int e = 0; e < width; ++e) pair[e] = load_row(j[e] + field) + flipped(load_row(i[e] + field), signs);
  transpose(pair);
  for (int e = 0; e < width; ++e) store_row(rows[field + e] + p, pair[e]);
}

/// The same from `field` on. No loop: signs are constants of each square.
template <Features F, int field = 0>
PACKMPI_INLINE void put_fields(Block<F>& b, int p, const double* const* i, const double* const* j) {
  put_square<F, field, false>(b.in, p, i, j);
  if constexpr (Memory<F>::twice(field)) put_square<F, field, true>(b.again, p, i, j);
  if constexpr (field + width < Memory<F>::rows) put_fields<F, field + width>(b, p, i, j);
}

/// Stage 1: records of both ends, differences and sums, transposed.
template <Features F>
PACKMPI_INLINE void pack(const double* records, Block<F>& b) {
  using M = Memory<F>;
  constexpr int stride = M::stride;
  for (int p = 0; p < b.filled; p += width) {
    const double* i[width];
    const double* j[width];
    for (int e = 0; e < width; ++e) {
      const int entry = b.entry[p + e];
      i[e] = records + std::int64_t{b.first[entry]} * stride;
      j[e] = records + std::int64_t{b.second[entry]} * stride;
    }
    put_fields<F>(b, p, i, j);
  }
}

/// Stage 3: integers back to one vector a pair, added to the accumulators of the first, and of the second what is the
/// same, negated or its own. What ghosts and the fill would get goes to the dump.
template <Features F>
PACKMPI_INLINE void scatter(const StepData& data, Block<F>& b) {
  using M = Memory<F>;
  constexpr int accumulators = M::accumulators;
  for (int p = 0; p < b.filled; p += width) {
    std::int64_t* i[width];
    std::int64_t* j[width];
    for (int e = 0; e < width; ++e) {
      const int entry = b.entry[p + e];
      i[e] = data.ring + std::int64_t{b.first_slot[entry]} * accumulators;
      j[e] = data.ring + std::int64_t{b.second_slot[entry]} * accumulators;
    }
    for (int a = 0; a < accumulators; a += width) {
      const BitRow flip = row_of<BitRow>([&](int e) { return M::minus(a + e); });
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
        store_row(i[e] + a, load_row(i[e] + a) + given[e]);
        store_row(j[e] + a, load_row(j[e] + a) + (((M::any_own ? taken[e] : given[e]) ^ flip) - flip));
      }
    }
  }
}

}  // namespace packmpi::dynamics::PACKMPI_KERNEL
