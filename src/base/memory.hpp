/// How much memory a process has needed.
#pragma once
#include <cstdint>

namespace packmpi {

/// The most memory this process has had resident since its start [B], of Linux's /proc; libraries are in it. 0 where it
/// cannot be read. Local.
[[nodiscard]] std::int64_t memory_high_water();

}  // namespace packmpi
