/// Wide integers in pieces that MPI can add. Private to this module; local.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace packmpi::comm {

__extension__ using Int128 = __int128;
__extension__ using Uint128 = unsigned __int128;

inline constexpr std::size_t limb_count = 4;  ///< of 32 bits, the last one with the sign

/// `sum` in limbs. Up to 2^31 of them may be added limb by limb: the sum of all is then below 2^159.
inline void split(Int128 sum, std::span<std::int64_t> limbs) {
  for (std::size_t k = 0; k + 1 < limb_count; ++k, sum >>= 32) {
    limbs[k] = static_cast<std::int64_t>(sum & 0xffffffffU);
  }
  limbs[limb_count - 1] = static_cast<std::int64_t>(sum);
}

/// What added limbs stand for, times 2^exponent, rounded to double once (twice where that is subnormal); 0: +0.
[[nodiscard]] double to_double(std::span<const std::int64_t> limbs, int exponent);

}  // namespace packmpi::comm
