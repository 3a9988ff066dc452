/// The terminal: is somebody looking, and does what is said arrive?
#pragma once
#include <string_view>

namespace packmpi {

/// True if what this process prints on stdout reaches a terminal. Under mpirun a rank's stdout is always a
/// pseudo-terminal of mpirun's making, so there the launcher's own stdout is looked at too (Linux /proc; unknown counts
/// as no). Local.
[[nodiscard]] bool stdout_is_terminal();

/// Writes `text` to stdout at once. What cannot be written is dropped, so that no run ends for it; stdout_failure()
/// remembers. Local.
void print(std::string_view text) noexcept;

/// The errno of the first print() that failed; 0: none did. Local.
[[nodiscard]] int stdout_failure() noexcept;

}  // namespace packmpi
