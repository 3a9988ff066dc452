/// Sums of doubles whose bits depend on no order and on no number of ranks: integers are added, and integers commute.
#pragma once
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "comm/comm.hpp"

namespace packmpi::comm {

/// A sum without rounding: bits of all exponents that doubles have, in limbs of 32 (the small superaccumulator of Neal
/// 2015, "Fast exact summation using small and large superaccumulators"). Local, of fixed size; 560 bytes.
class ExactSum {
 public:
  /// Limb k counts 2^(32 k - 1074); the last one has the sign. 2^60 of the largest doubles find room.
  static constexpr std::size_t limb_count = 68;
  /// Limbs, and behind them the number of terms that were NaN or infinite. May be added word by word, up to 2^30 of
  /// them, where each is settled.
  using Words = std::array<std::int64_t, limb_count + 1>;

  void add(double term) noexcept {
    const auto bits = std::bit_cast<std::uint64_t>(term);
    const auto biased = static_cast<unsigned>(bits >> 52U & 0x7ffU);
    if (biased == 0x7ffU) {
      ++words_[limb_count];
      return;
    }
    const std::uint64_t fraction = bits & 0xfffffffffffffU;
    const std::uint64_t mantissa = biased == 0 ? fraction : fraction | std::uint64_t{1} << 52U;
    const unsigned place = biased == 0 ? 0 : biased - 1;  // of its last bit, above 2^-1074
    add_at(place, term < 0.0 ? -static_cast<std::int64_t>(mantissa) : static_cast<std::int64_t>(mantissa));
    if (++unsettled_ == most_unsettled) settle();
  }

  /// Carries over, so that each limb but the last is in [0, 2^32).
  void settle() noexcept;
  [[nodiscard]] const Words& words() const noexcept { return words_; }
  [[nodiscard]] Words& words() noexcept { return words_; }
  /// Settles; the sum, rounded to double once. Zero is +0; NaN if a term was not finite, infinity beyond double's
  /// range.
  [[nodiscard]] double round() noexcept;

 private:
  static constexpr std::int64_t most_unsettled = std::int64_t{1} << 30;
  void add_at(unsigned place, std::int64_t mantissa) noexcept {
    __extension__ using Int128 = __int128;
    const Int128 wide = Int128{mantissa} * (Int128{1} << place % 32U);
    std::int64_t* const limb = &words_[place / 32U];
    limb[0] += static_cast<std::int64_t>(wide & 0xffffffffU);
    limb[1] += static_cast<std::int64_t>(wide >> 32 & 0xffffffffU);
    limb[2] += static_cast<std::int64_t>(wide >> 64);
  }

  Words words_{};
  std::int64_t unsettled_ = 0;  // terms since
};

/// Collective. Of each sum, what all ranks have added to theirs; as many sums on every rank, which are settled.
/// Cost: a reduction of 552 bytes a sum for each 4096 of them.
[[nodiscard]] std::vector<double> exact_sums(const Comm& comm, std::span<ExactSum> sums);
/// Collective. The same of one sum.
[[nodiscard]] double exact_sum(const Comm& comm, const ExactSum& sum);
/// Collective. The same of one sum, of all ranks' terms.
[[nodiscard]] double exact_sum(const Comm& comm, std::span<const double> terms);

}  // namespace packmpi::comm
