#include "comm/limbs.hpp"

#include <cmath>

namespace packmpi::comm {

double to_double(std::span<const std::int64_t> limbs, int exponent) {
  Uint128 low = 0;  // the sum is high 2^128 + low
  Int128 high = 0;
  for (std::size_t k = 0; k < limb_count; ++k, high >>= 32) {
    high += limbs[k];
    low |= static_cast<Uint128>(high & 0xffffffffU) << (32 * k);
  }
  const auto fits = [&] { return high == (static_cast<Int128>(low) < 0 ? -1 : 0); };
  for (; !fits(); ++exponent, high >>= 1) {  // the last bit stands for all below it: rounding sees it
    low = (low >> 1) | (low & 1U) | (static_cast<Uint128>(high & 1) << 127);
  }
  const auto sum = static_cast<Int128>(low);
  return sum == 0 ? 0.0 : std::ldexp(static_cast<double>(sum), exponent);
}

}  // namespace packmpi::comm
