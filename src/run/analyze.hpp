/// `packmpi analyze`: what a pack is like inside.
#pragma once
#include <string>

#include "comm/comm.hpp"
#include "geometry/columns.hpp"
#include "scene/scene.hpp"

namespace packmpi::run {

/// Collective. Analyses the pack at `path` and writes NAME.analysis.json beside it, the same bytes on any number of
/// ranks; an older one is replaced. Returns the table for the screen. Throws Error(io_failure).
[[nodiscard]] std::string analyze(const comm::Comm& comm, const std::string& path);

/// The columns of its measures, which reach 2.5 diameters: fewer than those of the run. Local.
[[nodiscard]] geometry::ColumnGrid analysis_columns(const scene::Scene& scene);

}  // namespace packmpi::run
