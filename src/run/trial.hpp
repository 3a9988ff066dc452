/// A sample, filled in with a given friction: what density comes of it.
#pragma once
#include <functional>

#include "control/sample.hpp"

namespace packmpi::run {

/// What is asked every 25 steps of a sample, on the rank that makes it; may end all by an Error. Empty: nobody is.
using Look = std::function<void()>;

/// Fills the sample in with one knob, and confines it if the target's density holds then, on this rank alone. Local: no
/// rank waits for another. Throws Error(numerical_failure) as a run would.
[[nodiscard]] control::Trial try_knob(const control::Sample& sample, control::Knob knob, const Look& look);

}  // namespace packmpi::run
