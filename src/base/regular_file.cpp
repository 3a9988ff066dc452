#include "base/regular_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace packmpi {
namespace {

std::string unopened(int number) { return "cannot be opened (" + std::generic_category().message(number) + ")"; }

}  // namespace

std::string kind_flaw(unsigned mode) {
  if (S_ISREG(mode)) return "";
  if (S_ISDIR(mode)) return "is a folder";
  const char* kind = S_ISFIFO(mode) ? "a FIFO" : S_ISSOCK(mode) ? "a socket" : S_ISLNK(mode) ? "a link" : "a device";
  return std::string("is ") + kind + ", not a regular file";
}

RegularFile::RegularFile(const std::string& path) {
  struct stat there {};
  if (stat(path.c_str(), &there) != 0) {
    flaw_ = unopened(errno);
    return;
  }
  flaw_ = kind_flaw(there.st_mode);  // before it is opened: that alone can move a device
  if (!flaw_.empty()) return;
  fd_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);  // nor does what came in between hold us up
  if (fd_ < 0 || fstat(fd_, &there) != 0) {
    flaw_ = unopened(errno);
    return;
  }
  flaw_ = kind_flaw(there.st_mode);
  size_ = there.st_size;
}

RegularFile::~RegularFile() {
  if (fd_ >= 0) ::close(fd_);
}

std::optional<std::string> RegularFile::read(std::int64_t begin, std::int64_t size) const {
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::pread(fd_, bytes.data() + done, bytes.size() - done, begin + static_cast<off_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return std::nullopt;
    if (got == 0) break;
    done += static_cast<std::size_t>(got);
  }
  bytes.resize(done);
  return bytes;
}

}  // namespace packmpi
