/// Digests: FNV-1a of texts, one byte after the other; a finaliser for what is made of numbers.
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

/// The finaliser of splitmix64 (Steele, Lea, Flood 2014): every bit of x stirs every bit of the result.
[[nodiscard]] constexpr std::uint64_t stir(std::uint64_t x) noexcept {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}

}  // namespace packmpi
