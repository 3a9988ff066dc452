/// What the outside wants of a run: signals, caught and kept until somebody looks.
#pragma once

namespace packmpi {

/// Bits of what signals have asked of this process since the last look.
enum class Wish : unsigned { none = 0, checkpoint = 1, stop = 2 };

/// From now on, to the end of the process: USR1 and USR2 do not kill it, and are kept for the next run: job systems
/// send them when it pleases them, before MPI is up and after the pack is written. For programs, first thing in main().
/// Local.
void keep_user_signals();

/// While it lives: USR1 asks for a checkpoint; USR2, TERM and INT ask for a checkpoint and the end; a second TERM or
/// INT ends the process at once. The handler only sets flags. The former handlers come back at the end. One at a time.
class Signals {
 public:
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;
};

/// What signals have asked this process for: the greater wish if both. A wish for a checkpoint is forgotten by asking,
/// a wish to stop is not. Local.
[[nodiscard]] Wish take_wish();
/// Has a signal asked for the end? Forgets nothing. Local.
[[nodiscard]] bool stop_wished();

}  // namespace packmpi
