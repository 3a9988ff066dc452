#include "cli/process.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "base/signals.hpp"

namespace packmpi::cli {
namespace {

/// Writing to what stands in for a closed stdout fails, as it would have before.
void take_closed_descriptors() {
  for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(fd, F_GETFD) >= 0 || errno != EBADF) continue;
    (void)::open("/dev/null", fd == STDERR_FILENO ? O_WRONLY : O_RDONLY);  // gets the lowest number that is free: fd
  }
}

}  // namespace

bool prepare_process() {
  keep_user_signals();
  for (const int number : {SIGPIPE, SIGXFSZ}) (void)std::signal(number, SIG_IGN);
  take_closed_descriptors();
  std::error_code gone;
  (void)std::filesystem::current_path(gone);
  if (!gone) return true;
  std::fprintf(stderr, "packmpi: the working folder cannot be found (%s); change to one that is there\n",
               gone.message().c_str());
  return false;
}

}  // namespace packmpi::cli
