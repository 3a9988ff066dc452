/// What a run has cost, rank by rank.
#pragma once
#include <cstdint>

#include "report/record.hpp"
#include "run/bed.hpp"

namespace packmpi::run {

/// Collective. Puts the counters of all ranks since their start, or restart, into the record of rank 0: counts, which
/// are the same in every run of a scene on as many ranks, and costs (times, memory), which are not. `touching` are the
/// touching pairs that this rank counts.
void count(const Bed& bed, std::int64_t touching, report::RunRecord& record);

}  // namespace packmpi::run
