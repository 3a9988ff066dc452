#include "base/random.hpp"

#include <Random123/philox.h>

#include <cassert>

namespace packmpi::random {
namespace {

using Philox = r123::Philox4x32;  // ten rounds
using Block = Philox::ctr_type;

constexpr std::uint32_t low(std::uint64_t x) { return static_cast<std::uint32_t>(x); }
constexpr std::uint32_t high(std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32U); }

/// Counter: 32 + 16 bits of the particle, 8 of the purpose, 8 of the block, 32 of the layer, 32 of the attempt.
Block philox(const Name& name, std::uint32_t block) noexcept {
  const auto purpose = static_cast<std::uint32_t>(name.purpose);
  assert(name.particle < (std::uint64_t{1} << 48U) && name.layer < (1U << 24U) && purpose < (1U << 8U));
  const Philox::key_type key{{low(name.seed), high(name.seed)}};
  const Block counter{
      {low(name.particle), high(name.particle) | purpose << 16U | block << 24U, name.layer, name.attempt}};
  return Philox()(counter, key);
}

std::array<std::uint64_t, 2> words_of(const Block& b) {
  return {b[0] | std::uint64_t{b[1]} << 32U, b[2] | std::uint64_t{b[3]} << 32U};
}

/// The upper 53 bits as a multiple of 2^-53: exact in a double.
double unit(std::uint64_t word) { return static_cast<double>(word >> 11U) * 0x1p-53; }

}  // namespace

std::array<std::uint64_t, 2> words(const Name& name) noexcept { return words_of(philox(name, 0)); }

std::array<double, 4> uniforms(const Name& name) noexcept {
  const auto first = words_of(philox(name, 0));
  const auto second = words_of(philox(name, 1));
  return {unit(first[0]), unit(first[1]), unit(second[0]), unit(second[1])};
}

}  // namespace packmpi::random
