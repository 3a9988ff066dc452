// Sums of doubles whose bits depend on no order: integers are added, and integers commute.
#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>

#include "comm/comm.hpp"
#include "comm/limbs.hpp"

namespace packmpi::comm {
namespace {

constexpr int fraction_bits = 96;  // 2^30 terms of 2^96 stay below 2^127 on a rank; all ranks together need more
constexpr std::size_t max_terms = std::size_t{1} << 30U;
constexpr std::size_t words_per_sum = limb_count + 1;  // and the number of ranks with too many terms

double magnitude(std::span<const double> terms) {
  double largest = 0.0;
  for (const double term : terms) {
    if (!std::isfinite(term)) return std::numeric_limits<double>::quiet_NaN();
    largest = std::max(largest, std::fabs(term));
  }
  return largest;
}

/// term = mantissa * 2^exponent, |mantissa| < 2^53.
struct Parts {
  std::int64_t mantissa;
  int exponent;
};
Parts parts_of(double term) {  // std::frexp is a call, and a row of the step log sums some ten numbers a particle
  const auto bits = std::bit_cast<std::uint64_t>(term);
  const auto biased = static_cast<int>(bits >> 52U & 0x7ffU);
  const auto fraction = static_cast<std::int64_t>(bits & 0xfffffffffffffU);
  const std::int64_t mantissa = biased == 0 ? fraction : fraction | std::int64_t{1} << 52U;
  return {std::signbit(term) ? -mantissa : mantissa, std::max(biased, 1) - 1075};
}

/// term / 2^(exponent - 96), rounded to the nearest integer, halves away from zero; |term| < 2^exponent.
Int128 fixed(double term, int exponent) {
  const Parts parts = parts_of(term);
  const int shift = parts.exponent - (exponent - fraction_bits);
  if (shift >= 0) return Int128{parts.mantissa} * (Int128{1} << shift);
  if (shift < -54) return 0;
  const std::int64_t half = std::int64_t{1} << (-shift - 1);
  const std::int64_t rounded = (std::abs(parts.mantissa) + half) >> -shift;
  return parts.mantissa < 0 ? -rounded : rounded;
}

Int128 local_sum(std::span<const double> terms, double largest) {
  if (!(largest > 0.0) || terms.size() > max_terms) return 0;  // not needed, or refused below
  int exponent = 0;
  (void)std::frexp(largest, &exponent);
  Int128 sum = 0;
  for (const double term : terms) sum += fixed(term, exponent);
  return sum;
}

double total(std::span<const std::int64_t> limbs, double largest) {
  if (std::isnan(largest)) return largest;
  int exponent = 0;
  (void)std::frexp(largest, &exponent);
  return to_double(limbs, exponent - fraction_bits);
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
    mine[limb_count] = terms[k].size() > max_terms ? 1 : 0;
  }
  comm.sum(std::span(words));

  std::vector<double> sums(n);
  for (std::size_t k = 0; k < n; ++k) {
    const auto all = std::span(words).subspan(k * words_per_sum, words_per_sum);
    if (all[limb_count] > 0)
      fail_together(comm, ExitCode::numerical_failure, "an exact sum of more than 2^30 terms of a rank");
    sums[k] = total(all.first(limb_count), largest[k]);
  }
  return sums;
}

double exact_sum(const Comm& comm, std::span<const double> terms) {
  const std::vector<double> only(terms.begin(), terms.end());
  return exact_sums(comm, std::span(&only, 1))[0];
}

}  // namespace packmpi::comm
