#include "base/digest.hpp"

#include <bit>

#include "particles/store.hpp"

namespace packmpi::particles {
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
