/// The key table for editors.
#pragma once
#include <string>

namespace packmpi::cli {

/// JSON Schema (draft 7) of scene files: every table and key with type, choices, bounds, default and meaning. TOML
/// editors complete and check by it. Conditions between keys are not in it: `packmpi check` knows them. Local.
[[nodiscard]] std::string scene_schema();

}  // namespace packmpi::cli
