/// Randomness as a pure function of names: no state, so ranks and restarts cannot change it.
/// Philox4x32-10 (Salmon et al. 2011) from Random123; no std:: distribution is used anywhere, their
/// results are not specified.
#pragma once
#include <array>
#include <cstdint>

namespace packmpi::random {

/// What a draw is for; each purpose is an independent stream. Values are below 2^8.
enum class Purpose : std::uint32_t { radius = 1, trial = 2, test = 3, measure = 4 };

/// The name of a draw. Two names within the bounds below never share a Philox counter.
struct Name {
  std::uint64_t seed;  ///< the scene's seed
  Purpose purpose;
  std::uint32_t layer;     ///< 0 .. ; below 2^24
  std::uint64_t particle;  ///< index of the particle in its layer, below 2^48
  std::uint32_t attempt;   ///< 0 .. ; a trial, or a trial of a rejection method
};

/// Two 64-bit words of the stream `name`: its first block. Bounds are asserted. Cost: one Philox block, 10 ns.
std::array<std::uint64_t, 2> words(const Name& name) noexcept;

/// Four numbers in [0, 1), multiples of 2^-53, independent of each other. The first two are made of words(name): take
/// either from a name, not both. Bounds are asserted. Cost: two Philox blocks.
std::array<double, 4> uniforms(const Name& name) noexcept;

}  // namespace packmpi::random
