/// `packmpi analyze`: what a pack is like inside.
#pragma once
#include <string>

#include "comm/comm.hpp"

namespace packmpi::run {

/// Collective. Analyses the pack at `path` and writes NAME.analysis.json beside it, the same bytes on any number of
/// ranks; an older one is replaced. Returns the table for the screen. Throws Error(io_failure).
[[nodiscard]] std::string analyze(const comm::Comm& comm, const std::string& path);

}  // namespace packmpi::run
