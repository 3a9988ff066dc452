/// FNV-1a, the digest of texts: any one byte changed changes it.
#pragma once
#include <cstdint>
#include <string_view>

namespace packmpi {

inline constexpr std::uint64_t fnv_start = 0xcbf29ce484222325ULL;  ///< digest of no bytes

/// The digest `hash` goes on with `bytes`. Local. Cost: O(bytes).
[[nodiscard]] constexpr std::uint64_t fnv_add(std::uint64_t hash, std::string_view bytes) noexcept {
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

}  // namespace packmpi
