/// Is somebody looking?
#pragma once

namespace packmpi {

/// True if what this process prints on stdout reaches a terminal. Under mpirun a rank's stdout is always a
/// pseudo-terminal of mpirun's making, so there the launcher's own stdout is looked at too (Linux /proc; unknown counts
/// as no). Local.
[[nodiscard]] bool stdout_is_terminal();

}  // namespace packmpi
