/// The step kernel's slow, obvious twin: one pair at a time, no blocks, no vectors, no ring.
#pragma once
#include "dynamics/kernel.hpp"

namespace packmpi::oracle {

/// One step of `data`, as the kernel for `features` does it. Forces found in the accumulators (near field) count, when
/// they hold every particle; they are not cleared. max_speed is the bound by axes that the kernel returns.
dynamics::StepReport step(const scene::Features& features, const dynamics::StepData& data);

}  // namespace packmpi::oracle
