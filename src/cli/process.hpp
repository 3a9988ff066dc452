/// What the process is to the system, before anything else begins.
#pragma once

namespace packmpi::cli {

/// First thing in main(), before MPI: signals that must not kill a run (USR1, USR2: base/signals.hpp; a closed pipe and
/// a file beyond `ulimit -f` become write errors, which are told); descriptors 0 to 2 that are closed are taken, so
/// that no file of ours gets their number and what is printed. False, with a line on stderr, where the working folder
/// is gone. Local.
[[nodiscard]] bool prepare_process();

}  // namespace packmpi::cli
