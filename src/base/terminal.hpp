/// The terminal: is somebody looking, and does what is said arrive?
#pragma once
#include <string_view>

namespace packmpi {

/// True if what this process says on stderr reaches a terminal. Under mpirun a rank's stderr is a pipe, so there the
/// launcher's own is looked at (Linux /proc; unknown counts as no). Local.
[[nodiscard]] bool stderr_is_terminal();

/// Writes `text` to stderr at once, where the log goes, too: so both come in order. Failures are nobody's. Local.
void note(std::string_view text) noexcept;

/// Writes `text` to stdout at once. What cannot be written is dropped, so that no run ends for it; stdout_failure()
/// remembers. Local.
void print(std::string_view text) noexcept;

/// The errno of the first print() that failed; 0: none did. Local.
[[nodiscard]] int stdout_failure() noexcept;

}  // namespace packmpi
