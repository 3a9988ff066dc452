#include "comm/exact_sum.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace packmpi::comm {

void ExactSum::settle() noexcept {
  std::int64_t carry = 0;
  for (std::size_t k = 0; k + 1 < limb_count; ++k) {
    const std::int64_t all = words_[k] + carry;
    words_[k] = all & 0xffffffff;
    carry = all >> 32;
  }
  words_[limb_count - 1] += carry;
  unsettled_ = 0;
}

double ExactSum::round() noexcept {
  settle();
  if (words_[limb_count] > 0) return std::numeric_limits<double>::quiet_NaN();
  const bool negative = words_[limb_count - 1] < 0;
  ExactSum size;
  for (std::size_t k = 0; k < limb_count; ++k) size.words_[k] = negative ? -words_[k] : words_[k];
  size.settle();
  std::size_t top = limb_count - 1;
  while (top > 0 && size.words_[top] == 0) --top;
  const std::size_t last = top < 3 ? 0 : top - 3;  // 97 bits or more, or all there are
  __extension__ using Uint128 = unsigned __int128;
  Uint128 bits = 0;
  for (std::size_t k = top + 1; k > last; --k) bits = bits << 32U | static_cast<Uint128>(size.words_[k - 1]);
  // The last bit stands for all below it: rounding sees it.
  if (std::any_of(size.words_.begin(), size.words_.begin() + static_cast<std::ptrdiff_t>(last),
                  [](std::int64_t limb) { return limb != 0; }))
    bits |= 1U;
  const double sum = std::ldexp(static_cast<double>(bits), 32 * static_cast<int>(last) - 1074);
  return negative ? -sum : sum;
}

namespace {

// The next totals, of sums whose words are few enough for one message.
void add_totals(const Comm& comm, std::span<ExactSum> sums, std::vector<double>& totals) {
  std::vector<std::int64_t> words;
  words.reserve(sums.size() * std::tuple_size_v<ExactSum::Words>);
  for (ExactSum& sum : sums) {
    sum.settle();
    words.insert(words.end(), sum.words().begin(), sum.words().end());
  }
  comm.sum(std::span(words));
  auto at = words.begin();
  for (std::size_t k = 0; k < sums.size(); ++k, at += std::tuple_size_v<ExactSum::Words>) {
    ExactSum all;
    std::copy_n(at, all.words().size(), all.words().begin());
    totals.push_back(all.round());
  }
}

}  // namespace

std::vector<double> exact_sums(const Comm& comm, std::span<ExactSum> sums) {
  constexpr std::size_t at_once = 4096;  // 2 MB
  std::vector<double> totals;
  totals.reserve(sums.size());
  for (; !sums.empty(); sums = sums.subspan(std::min(at_once, sums.size())))
    add_totals(comm, sums.first(std::min(at_once, sums.size())), totals);
  return totals;
}

double exact_sum(const Comm& comm, const ExactSum& sum) {
  ExactSum own = sum;
  return exact_sums(comm, std::span(&own, 1))[0];
}

double exact_sum(const Comm& comm, std::span<const double> terms) {
  ExactSum sum;
  for (const double term : terms) sum.add(term);
  return exact_sum(comm, sum);
}

}  // namespace packmpi::comm
