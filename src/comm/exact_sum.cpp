// Sums of doubles whose bits depend on no order: 128-bit integers are added, and integers commute.
#include <cassert>
#include <cmath>
#include <limits>

#include "comm/comm.hpp"

namespace packmpi::comm {
namespace {

__extension__ using Int128 = __int128;
__extension__ using Uint128 = unsigned __int128;

constexpr int fraction_bits = 96;  // 2^30 terms of 2^96 stay below 2^127
constexpr std::int64_t max_terms = std::int64_t{1} << 30U;
constexpr std::size_t limbs = 4;                  // of 32 bits: 2^31 ranks of them fit an int64
constexpr std::size_t words_per_sum = limbs + 1;  // and the number of terms

double magnitude(std::span<const double> terms) {
  double largest = 0.0;
  for (const double term : terms) {
    if (!std::isfinite(term)) return std::numeric_limits<double>::quiet_NaN();
    largest = std::fmax(largest, std::fabs(term));
  }
  return largest;
}

/// term / 2^(exponent - 96), rounded to the nearest integer, halves away from zero; |term| < 2^exponent.
Int128 fixed(double term, int exponent) {
  int own = 0;
  const auto mantissa = static_cast<std::int64_t>(std::frexp(term, &own) * 0x1p53);  // term = mantissa 2^(own - 53)
  const int shift = own - 53 - (exponent - fraction_bits);
  if (shift >= 0) return Int128{mantissa} * (Int128{1} << shift);
  if (shift < -54) return 0;
  const std::int64_t half = std::int64_t{1} << (-shift - 1);
  const std::int64_t rounded = (std::abs(mantissa) + half) >> -shift;
  return mantissa < 0 ? -rounded : rounded;
}

Int128 local_sum(std::span<const double> terms, double largest) {
  if (!(largest > 0.0) || static_cast<std::int64_t>(terms.size()) > max_terms)
    return 0;  // not needed, or refused below
  int exponent = 0;
  (void)std::frexp(largest, &exponent);
  Int128 sum = 0;
  for (const double term : terms) sum += fixed(term, exponent);
  return sum;
}

void split(Int128 sum, std::span<std::int64_t> out) {
  for (std::size_t k = 0; k + 1 < limbs; ++k, sum >>= 32) out[k] = static_cast<std::int64_t>(sum & 0xffffffffU);
  out[limbs - 1] = static_cast<std::int64_t>(sum);  // the top limb carries the sign
}

/// The limbs may each be larger than 32 bits by now; modulo 2^128 that is no matter.
Int128 join(std::span<const std::int64_t> in) {
  Uint128 sum = 0;
  for (std::size_t k = 0; k < limbs; ++k) sum += static_cast<Uint128>(Int128{in[k]}) << (32 * k);
  return static_cast<Int128>(sum);
}

double to_double(Int128 sum, double largest) {
  if (std::isnan(largest)) return largest;
  if (sum == 0) return 0.0;
  int exponent = 0;
  (void)std::frexp(largest, &exponent);
  return std::ldexp(static_cast<double>(sum), exponent - fraction_bits);
}

}  // namespace

std::vector<double> exact_sums(const Comm& comm, std::span<const std::vector<double>> terms) {
  const std::size_t n = terms.size();
  std::vector<double> largest(n);
  for (std::size_t k = 0; k < n; ++k) largest[k] = magnitude(terms[k]);
  comm.max(std::span(largest));

  std::vector<std::int64_t> words(n * words_per_sum);
  for (std::size_t k = 0; k < n; ++k) {
    const auto mine = std::span(words).subspan(k * words_per_sum, words_per_sum);
    split(local_sum(terms[k], largest[k]), mine);
    mine[limbs] = static_cast<std::int64_t>(terms[k].size());
  }
  comm.sum(std::span(words));

  std::vector<double> sums(n);
  for (std::size_t k = 0; k < n; ++k) {
    const auto all = std::span(words).subspan(k * words_per_sum, words_per_sum);
    if (all[limbs] > max_terms) throw Error(ExitCode::numerical_failure, "an exact sum of more than 2^30 terms");
    sums[k] = to_double(join(all), largest[k]);
  }
  return sums;
}

double exact_sum(const Comm& comm, std::span<const double> terms) {
  const std::vector<double> only(terms.begin(), terms.end());
  return exact_sums(comm, std::span(&only, 1))[0];
}

}  // namespace packmpi::comm
