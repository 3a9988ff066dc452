#include "base/terminal.hpp"

#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace packmpi {
namespace {

int print_failure = 0;

}  // namespace

bool stderr_is_terminal() {
  if (std::getenv("OMPI_COMM_WORLD_SIZE") == nullptr) return isatty(STDERR_FILENO) != 0;
  std::error_code unknown;
  const auto target = std::filesystem::read_symlink("/proc/" + std::to_string(getppid()) + "/fd/2", unknown);
  return !unknown && (target.string().starts_with("/dev/pts/") || target.string().starts_with("/dev/tty"));
}

void note(std::string_view text) noexcept {
  (void)std::fwrite(text.data(), 1, text.size(), stderr);  // as spdlog does
  (void)std::fflush(stderr);
}

// Not through stdio: it would keep what it could not write, and whoever flushes it at the end would fail again.
void print(std::string_view text) noexcept {
  (void)std::fflush(stdout);  // PETSc's reports go that way
  while (!text.empty() && print_failure == 0) {
    const ssize_t written = ::write(STDOUT_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0 && errno == EAGAIN) {  // somebody made it non-blocking
      pollfd room{.fd = STDOUT_FILENO, .events = POLLOUT, .revents = 0};
      (void)poll(&room, 1, -1);
      continue;
    }
    if (written <= 0) {
      print_failure = written == 0 ? ENOSPC : errno;
    } else {
      text.remove_prefix(static_cast<std::size_t>(written));
    }
  }
}

int stdout_failure() noexcept { return print_failure; }

}  // namespace packmpi
