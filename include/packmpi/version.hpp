/// Which packmpi this is. The three texts go into the provenance of every pack. Local, no MPI needed, cost none.
#pragma once
#include <string_view>

namespace packmpi {

/// The release, for example "0.2.0".
[[nodiscard]] std::string_view version() noexcept;

/// What git describes the sources as, for example "v0.2.0-3-g0123456789ab-dirty"; "unknown" outside a clone.
[[nodiscard]] std::string_view git_id() noexcept;

/// The compiler the library was built with, for example "GNU 12.2.0".
[[nodiscard]] std::string_view compiler() noexcept;

}  // namespace packmpi
