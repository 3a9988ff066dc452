/// Names that people bring from other codes and papers, and what stands for them here.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace packmpi::tables {

/// A sentence for a key that a scene has not, "not in this version: ..." or the key that is meant; none for names that
/// nobody knows. `table` is where it stands, "contact". Local, pure.
[[nodiscard]] std::optional<std::string> known_elsewhere(std::string_view table, std::string_view name);

}  // namespace packmpi::tables
