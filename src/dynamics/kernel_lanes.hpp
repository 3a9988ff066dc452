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

/// Rows become columns.
template <class V>
PACKMPI_INLINE void transpose(V& a, V& b, V& c, V& d) {
  const V ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const V ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const V cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const V cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}

/// x rounded to the nearest integer, ties to even; |x| < 2^51. No CPU before AVX-512 converts lanes of 64 bits.
PACKMPI_INLINE std::int64_t to_integer(double x) {
  constexpr double shift = 6755399441055744.0;  // 1.5 * 2^52: a double this large has unit spacing
  constexpr std::uint64_t shift_bits = 0x4338000000000000;
  return static_cast<std::int64_t>(__builtin_bit_cast(std::uint64_t, x + shift) - shift_bits);
}

}  // namespace packmpi::dynamics::PACKMPI_KERNEL
