#include <bit>

#include "particles/store.hpp"

namespace packmpi::particles {
namespace {

/// The finaliser of splitmix64 (Steele, Lea, Flood 2014): every bit of x stirs every bit of the result.
constexpr std::uint64_t stir(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31U);
}

}  // namespace

std::uint64_t digest(const Store& store) {
  const int fields = store.layout().used_doubles();
  std::uint64_t sum = 0;
  for (LocalIndex i = 0; i < store.owned(); ++i) {
    std::uint64_t hash = stir(static_cast<std::uint64_t>(store.ids()[static_cast<std::size_t>(i)]));
    const double* record = store.record(i);
    for (int k = 0; k < fields; ++k) hash = stir(hash ^ std::bit_cast<std::uint64_t>(record[k]));
    sum += hash;
  }
  return sum;
}

}  // namespace packmpi::particles
