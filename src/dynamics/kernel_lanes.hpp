/// Four-lane vectors of the step kernels. Included by kernel_impl.cpp only, once for each instruction set: everything
/// is in that build's own namespace and always inlined, so that no code for a newer CPU can be linked into an older
/// path.
#pragma once
#include <cstdint>

#define PACKMPI_INLINE inline __attribute__((always_inline))

namespace packmpi::dynamics::PACKMPI_KERNEL {

using Lanes = double __attribute__((vector_size(32)));
using IntLanes = std::int64_t __attribute__((vector_size(32)));
using BitLanes = std::uint64_t __attribute__((vector_size(32)));  // sums wrap: only the dump slot ever does
using LanesInMemory = double __attribute__((vector_size(32), aligned(8), may_alias));
using BitLanesInMemory = std::uint64_t __attribute__((vector_size(32), aligned(8), may_alias));
using HalfInMemory = double __attribute__((vector_size(16), aligned(8), may_alias));

PACKMPI_INLINE Lanes load(const double* p) { return *reinterpret_cast<const LanesInMemory*>(p); }
PACKMPI_INLINE void store(double* p, Lanes a) { *reinterpret_cast<LanesInMemory*>(p) = a; }
PACKMPI_INLINE BitLanes load_bits(const std::int64_t* p) { return *reinterpret_cast<const BitLanesInMemory*>(p); }
PACKMPI_INLINE void store_bits(std::int64_t* p, BitLanes a) { *reinterpret_cast<BitLanesInMemory*>(p) = a; }

/// Two lanes from memory, the others zero.
PACKMPI_INLINE Lanes load_half(const double* p) {
  const HalfInMemory a = *reinterpret_cast<const HalfInMemory*>(p);
  return Lanes{a[0], a[1], 0.0, 0.0};
}
PACKMPI_INLINE void store_half(double* p, Lanes a) { *reinterpret_cast<HalfInMemory*>(p) = HalfInMemory{a[0], a[1]}; }

PACKMPI_INLINE Lanes spread(double a) { return Lanes{a, a, a, a}; }
PACKMPI_INLINE Lanes as_doubles(BitLanes a) { return reinterpret_cast<Lanes>(a); }
PACKMPI_INLINE BitLanes as_bits(Lanes a) { return reinterpret_cast<BitLanes>(a); }
PACKMPI_INLINE Lanes magnitude(Lanes a) {
  constexpr std::uint64_t all_but_sign = 0x7fffffffffffffff;
  return as_doubles(as_bits(a) & BitLanes{all_but_sign, all_but_sign, all_but_sign, all_but_sign});
}

/// A root or quotient of a sum of squares that may be zero stays finite with this added. Far below the square of any
/// distance or speed that matters.
constexpr double tiny = 1e-300;

PACKMPI_INLINE double root(double x) { return __builtin_sqrt(x); }
PACKMPI_INLINE double magnitude(double x) { return __builtin_fabs(x); }
PACKMPI_INLINE double with_sign_of(double x, double sign) { return __builtin_copysign(x, sign); }

// Records become structures of arrays in squares as wide as a register: without AVX the halves of four lanes would be
// put together in memory.
#ifdef __AVX__
constexpr int width = 4;
#else
constexpr int width = 2;
#endif
constexpr int square_bytes = 8 * width;
using Row = double __attribute__((vector_size(square_bytes)));
using BitRow = std::uint64_t __attribute__((vector_size(square_bytes)));
using RowInMemory = double __attribute__((vector_size(square_bytes), aligned(8), may_alias));
using BitRowInMemory = std::uint64_t __attribute__((vector_size(square_bytes), aligned(8), may_alias));

PACKMPI_INLINE Row load_row(const double* p) { return *reinterpret_cast<const RowInMemory*>(p); }
PACKMPI_INLINE void store_row(double* p, Row a) { *reinterpret_cast<RowInMemory*>(p) = a; }
PACKMPI_INLINE BitRow load_row(const std::int64_t* p) { return *reinterpret_cast<const BitRowInMemory*>(p); }
PACKMPI_INLINE void store_row(std::int64_t* p, BitRow a) { *reinterpret_cast<BitRowInMemory*>(p) = a; }
PACKMPI_INLINE Row flipped(Row a, BitRow signs) { return reinterpret_cast<Row>(reinterpret_cast<BitRow>(a) ^ signs); }

/// Of the number that `of` gives for each lane: at once, as lanes that are set one by one stay in memory.
template <class V, class Number>
PACKMPI_INLINE V row_of(const Number& of) {
#ifdef __AVX__
  return V{of(0), of(1), of(2), of(3)};
#else
  return V{of(0), of(1)};
#endif
}

/// Rows become columns.
template <class V>
PACKMPI_INLINE void transpose(V (&row)[width]) {
#ifdef __AVX__
  const V even = __builtin_shufflevector(row[0], row[1], 0, 4, 2, 6);
  const V odd = __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7);
  const V next_even = __builtin_shufflevector(row[2], row[3], 0, 4, 2, 6);
  const V next_odd = __builtin_shufflevector(row[2], row[3], 1, 5, 3, 7);
  row[0] = __builtin_shufflevector(even, next_even, 0, 1, 4, 5);
  row[1] = __builtin_shufflevector(odd, next_odd, 0, 1, 4, 5);
  row[2] = __builtin_shufflevector(even, next_even, 2, 3, 6, 7);
  row[3] = __builtin_shufflevector(odd, next_odd, 2, 3, 6, 7);
#else
  const V even = __builtin_shufflevector(row[0], row[1], 0, 2);
  row[1] = __builtin_shufflevector(row[0], row[1], 1, 3);
  row[0] = even;
#endif
}

/// The sum of each row's lanes, in the lane of its number.
PACKMPI_INLINE Row sums(const Row (&row)[width]) {
#ifdef __AVX__
  const Row first =
      __builtin_shufflevector(row[0], row[1], 0, 4, 2, 6) + __builtin_shufflevector(row[0], row[1], 1, 5, 3, 7);
  const Row last =
      __builtin_shufflevector(row[2], row[3], 0, 4, 2, 6) + __builtin_shufflevector(row[2], row[3], 1, 5, 3, 7);
  return __builtin_shufflevector(first, last, 0, 1, 4, 5) + __builtin_shufflevector(first, last, 2, 3, 6, 7);
#else
  return __builtin_shufflevector(row[0], row[1], 0, 2) + __builtin_shufflevector(row[0], row[1], 1, 3);
#endif
}

/// x rounded to the nearest integer, ties to even; |x| < 2^51. No CPU before AVX-512 converts lanes of 64 bits.
PACKMPI_INLINE std::int64_t to_integer(double x) {
  constexpr double shift = 6755399441055744.0;  // 1.5 * 2^52: a double this large has unit spacing
  constexpr std::uint64_t shift_bits = 0x4338000000000000;
  return static_cast<std::int64_t>(__builtin_bit_cast(std::uint64_t, x + shift) - shift_bits);
}

}  // namespace packmpi::dynamics::PACKMPI_KERNEL
