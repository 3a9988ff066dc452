/// A scene to begin with.
#pragma once
#include <string>

namespace packmpi::cli {

/// A valid scene of `dimension` 2 or 3 in which every key stands with its meaning: those without a default with an
/// example's value, the others commented out at their defaults. For `packmpi init`. Local.
[[nodiscard]] std::string starter(int dimension);

}  // namespace packmpi::cli
