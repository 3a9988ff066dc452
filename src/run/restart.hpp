/// Going on from a checkpoint.
#pragma once
#include <cstddef>
#include <cstdint>

#include "run/bed.hpp"
#include "run/files.hpp"
#include "run/options.hpp"

namespace packmpi::run {

/// What a run goes on from.
struct Origin {
  bool restarted = false;
  std::int64_t serial = 0;    ///< of the next checkpoint
  std::size_t next_slot = 0;  ///< for it: never the one this run came from
};

/// Collective. Puts an untouched bed to where the checkpoint of options.restart left them; "auto":
/// the newest valid slot, saying which others are passed over and why; from the beginning if there is none at all.
/// Throws Error(bad_checkpoint) on all ranks: nothing valid, or the scene is another one (with the keys that differ).
[[nodiscard]] Origin resume(const Files& files, const Options& options, Bed& bed);

}  // namespace packmpi::run
