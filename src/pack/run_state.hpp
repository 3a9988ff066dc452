/// A run's state as text and back, exactly. Private to this module.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

#include "pack/checkpoint.hpp"

namespace packmpi::pack {

/// All of `state` but effective_input, as JSON: doubles come back as the same bits. Local.
[[nodiscard]] std::string to_text(const RunState& state);
/// The state of to_text(). Throws Error(bad_checkpoint) if it is none.
[[nodiscard]] RunState state_of(const std::string& text);

/// FNV-1a: any one byte changed changes the number.
[[nodiscard]] constexpr std::uint64_t hash_of(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

}  // namespace packmpi::pack
