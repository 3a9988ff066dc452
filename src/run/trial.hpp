/// A sample, filled in with a given friction: what density comes of it.
#pragma once
#include "control/sample.hpp"

namespace packmpi::run {

/// Fills the sample in with one knob, and confines it if the target's density holds then, on this rank alone. Local: no
/// rank waits for another. Throws Error(numerical_failure) as a run would.
[[nodiscard]] control::Trial try_knob(const control::Sample& sample, control::Knob knob);

}  // namespace packmpi::run
