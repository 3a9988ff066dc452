/// What a rank sent and how often it met the others: exact counts, the same in every run of a scene on as many ranks.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace packmpi::comm {

/// What a message is for.
enum class Purpose : std::size_t { ghosts, halo, migration, frozen, insertion, output, other };
inline constexpr std::size_t purposes = 7;

/// Messages to other ranks; what a rank hands to itself is none.
struct Traffic {
  std::int64_t messages = 0;
  std::int64_t bytes = 0;
};

/// Of a communicator, this rank, since its construction. Not in them: what libraries send by themselves (HDF5's
/// collective writes, DMDA, Krylov solvers).
struct Counters {
  std::array<Traffic, purposes> sent{};
  std::int64_t reductions = 0;  ///< sums, extremes, prefix sums, agreements: one for each call
  std::int64_t exchanges = 0;   ///< of parcels; each ends with a barrier
};

}  // namespace packmpi::comm
