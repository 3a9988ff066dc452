/// Names that files of former format versions have, and what they are now. Private to this module.
#pragma once
#include <string>

namespace packmpi::pack {

/// The effective scene in a pack of version 1 or a checkpoint of version 2, with the keys of today. Local.
[[nodiscard]] std::string scene_in_present_names(const std::string& scene);
/// The state in a checkpoint of version 2, with the names of today. Local.
[[nodiscard]] std::string state_in_present_names(std::string state);

}  // namespace packmpi::pack
