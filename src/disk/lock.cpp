#include "disk/lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <utility>

#include "base/error.hpp"
#include "disk/files.hpp"

namespace packmpi::disk {
namespace {

constexpr int lock_mode = 0644;
constexpr int lock_flags = O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK;  // a FIFO in its place does not hang

struct flock whole_file() {
  struct flock range {};
  range.l_type = F_WRLCK;
  range.l_whence = SEEK_SET;
  return range;
}

// "process 1234 on node7", as the holder wrote it.
std::string holder_in(int fd) {
  std::array<char, 128> text{};
  const ssize_t size = pread(fd, text.data(), text.size(), 0);
  std::string words(text.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  std::erase_if(words, [](char c) { return c < ' ' || c > '~'; });
  return words.empty() ? "another process" : words;
}

[[noreturn]] void refuse(const std::string& path, int fd) {
  const std::string holder = holder_in(fd);
  ::close(fd);
  throw Error(ExitCode::bad_input,
              fmt::format("{} is held by {}: a run with these outputs is at work; wait for it or stop it, or use -o "
                          "FOLDER for another one",
                          path, holder));
}

// Is the open file the one that has the name now? Who held it before may have removed it meanwhile.
bool has_name(int fd, const std::string& path) {
  struct stat mine {
  }, named{};
  return fstat(fd, &mine) == 0 && lstat(path.c_str(), &named) == 0 && mine.st_dev == named.st_dev &&
         mine.st_ino == named.st_ino;
}

// Says in the file who has it; words only, so a full disk does not matter.
void sign(int fd) {
  std::array<char, HOST_NAME_MAX + 1> host{};
  (void)gethostname(host.data(), host.size() - 1);
  const std::string words = fmt::format("process {} on {}\n", getpid(), host.data());
  if (ftruncate(fd, 0) == 0) (void)!pwrite(fd, words.data(), words.size(), 0);
}

int open_plain(const std::string& path) {
  const int fd = ::open(path.c_str(), lock_flags | O_CREAT, lock_mode);
  if (fd < 0) fail(path, "open", errno);
  struct stat info {};
  if (fstat(fd, &info) == 0 && S_ISREG(info.st_mode)) return fd;
  ::close(fd);
  throw Error(ExitCode::io_failure, path + " is no plain file, as the lock of a run must be; remove it");
}

}  // namespace

Lock::Lock(const std::string& path) : path_(path) {
  while (true) {  // ends: another turn means that a holder has come and gone
    const int fd = open_plain(path);
    struct flock range = whole_file();
    if (fcntl(fd, F_OFD_SETLK, &range) != 0) {
      if (errno == EAGAIN || errno == EACCES) refuse(path, fd);
      discard(path);  // no locks here
      ::close(fd);
      return;
    }
    if (has_name(fd, path)) {
      sign(fd);
      fd_ = fd;
      return;
    }
    ::close(fd);
  }
}

Lock::~Lock() { release(); }

Lock::Lock(Lock&& other) noexcept : path_(std::move(other.path_)), fd_(std::exchange(other.fd_, -1)) {}

Lock& Lock::operator=(Lock&& other) noexcept {
  if (this != &other) {
    release();
    path_ = std::move(other.path_);
    fd_ = std::exchange(other.fd_, -1);
  }
  return *this;
}

void Lock::release() noexcept {
  if (fd_ < 0) return;
  discard(path_);  // while it is held: whoever opened it meanwhile finds that it has lost its name
  ::close(std::exchange(fd_, -1));
}

void refuse_if_locked(const std::string& path) {
  const int fd = ::open(path.c_str(), lock_flags);
  if (fd < 0) return;  // nobody, or nobody whose lock could be seen
  struct flock range = whole_file();
  if (fcntl(fd, F_OFD_GETLK, &range) == 0 && range.l_type != F_UNLCK) refuse(path, fd);
  ::close(fd);
}

}  // namespace packmpi::disk
