/// A run's state as text and back, exactly. Private to this module.
#pragma once
#include <string>

#include "pack/checkpoint.hpp"

namespace packmpi::pack {

/// All of `state` but effective_input, as JSON: doubles come back as the same bits. Local.
[[nodiscard]] std::string to_text(const RunState& state);
/// The state of to_text(). Throws Error(bad_checkpoint) if it is none.
[[nodiscard]] RunState state_of(const std::string& text);
/// The same of a former format version, in the names of today: what is new since then has its default, and the series
/// is of unknown length.
[[nodiscard]] RunState former_state_of(const std::string& text);

}  // namespace packmpi::pack
