#include "disk/files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <vector>

#include "base/error.hpp"
#include "base/regular_file.hpp"

namespace packmpi::disk {
namespace {

constexpr int file_mode = 0644;

std::string reason(int number) { return std::generic_category().message(number); }

/// Bytes a user may still write beside PATH; the largest number if the system does not tell.
std::int64_t free_bytes(const std::string& path) {
  struct statvfs info {};
  if (statvfs(folder_of(path).c_str(), &info) != 0) return INT64_MAX;
  const auto free = static_cast<std::uint64_t>(info.f_bavail) * info.f_frsize;
  return free > INT64_MAX ? INT64_MAX : static_cast<std::int64_t>(free);
}

/// `bytes` of the file on the disk to be, and its size, so that limits on it are met too.
void reserve_open(const Descriptor& file, const std::string& path, std::int64_t bytes) {
  if (bytes <= 0 || fallocate(file.get(), 0, 0, bytes) == 0) return;
  const int number = errno;
  const bool unsupported = number == EOPNOTSUPP || number == ENOSYS || number == EINVAL;
  if (unsupported && free_bytes(path) >= bytes) return;
  const int shown = unsupported ? ENOSPC : number;
  fail(path, fmt::format("{:.1f} MB needed", static_cast<double>(bytes) * 1e-6), shown);
}

[[noreturn]] void refuse_kind(const std::string& path, const std::string& flaw) {
  throw Error(ExitCode::io_failure, fmt::format("cannot write {}: it {}; remove it", path, flaw));
}

}  // namespace

void fail(const std::string& path, std::string_view what, int number) {
  throw Error(ExitCode::io_failure, fmt::format("cannot write {}: {}: {}", path, what, reason(number)));
}

Descriptor::Descriptor(const std::string& path, int flags) : path_(path), fd_(-1) {
  const bool folder = (flags & O_DIRECTORY) != 0;
  const int safely = folder ? 0 : O_NOFOLLOW | O_NONBLOCK | O_NOCTTY;
  fd_ = ::open(path.c_str(), flags | safely | O_CLOEXEC, file_mode);
  if (fd_ < 0) fail(path, "open", errno);
  struct stat there {};
  if (folder || fstat(fd_, &there) != 0) return;
  if (const std::string flaw = kind_flaw(there.st_mode); !flaw.empty()) {
    ::close(fd_);  // the destructor does not run
    refuse_kind(path, flaw);
  }
}

Descriptor Descriptor::create(const std::string& path) {
  struct stat there {};
  if (lstat(path.c_str(), &there) == 0) {
    const std::string flaw = kind_flaw(there.st_mode);
    if (!flaw.empty() && !S_ISLNK(there.st_mode)) refuse_kind(path, flaw);
    discard(path);
  }
  return {path, O_WRONLY | O_CREAT | O_EXCL};
}

Descriptor::~Descriptor() {
  if (fd_ >= 0) ::close(fd_);
}

void Descriptor::close() {
  const int closed = ::close(fd_);
  fd_ = -1;
  if (closed != 0) fail(path_, "close", errno);
}

void Descriptor::write_at(std::span<const std::byte> bytes, std::int64_t at) {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(fd_, bytes.data(), bytes.size(), at);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail(path_, "write", written == 0 ? ENOSPC : errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
    at += written;
  }
}

void Descriptor::sync() {
  if (fsync(fd_) != 0) fail(path_, "fsync", errno);
}

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

void reserve(const std::string& path, std::int64_t bytes) {
  Descriptor file = Descriptor::create(path);
  try {
    reserve_open(file, path, bytes);
  } catch (const Error&) {
    discard(path);
    throw;
  }
  file.close();
}

MemoryFile::MemoryFile(const std::string& for_what) : fd_(memfd_create("packmpi", MFD_CLOEXEC)) {
  if (fd_ < 0) fail(for_what, "a file in memory", errno);
}

void MemoryFile::expect(std::int64_t bytes, const std::string& for_what) const {
  if (ftruncate(fd_, bytes) != 0 || ftruncate(fd_, 0) != 0) {
    fail(for_what, fmt::format("{:.1f} MB needed", static_cast<double>(bytes) * 1e-6), errno);
  }
}

MemoryFile::~MemoryFile() { ::close(fd_); }

bool MemoryFile::stand_in_for(int fd) const noexcept { return dup3(fd_, fd, O_CLOEXEC) >= 0; }

std::int64_t MemoryFile::size() const {
  const off_t size = lseek(fd_, 0, SEEK_END);
  if (size < 0) fail("a file in memory", "seek", errno);
  return size;
}

std::string MemoryFile::read(std::int64_t begin, std::int64_t size) const {
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (pread(fd_, bytes.data(), bytes.size(), begin) != size) {
    throw Error(ExitCode::io_failure, "cannot read from memory what was written there");
  }
  return bytes;
}

void MemoryFile::copy_to(Descriptor& disk) const {
  const off_t size = lseek(fd_, 0, SEEK_END);
  reserve_open(disk, disk.path(), size);
  if (ftruncate(disk.get(), size) != 0) fail(disk.path(), "truncate", errno);
  std::vector<std::byte> bytes;
  for (off_t begin = lseek(fd_, 0, SEEK_DATA); begin >= 0;) {  // below 0: no more data
    const off_t end = lseek(fd_, begin, SEEK_HOLE);
    bytes.resize(static_cast<std::size_t>(end - begin));
    if (pread(fd_, bytes.data(), bytes.size(), begin) != end - begin) fail(disk.path(), "read from memory", EIO);
    disk.write_at(bytes, begin);
    begin = lseek(fd_, end, SEEK_DATA);
  }
}

void commit(const std::string& temporary, const std::string& path) {
  Descriptor file(temporary, O_WRONLY);
  file.sync();
  file.close();
  if (std::rename(temporary.c_str(), path.c_str()) != 0) fail(path, "rename", errno);
  Descriptor folder(folder_of(path), O_RDONLY | O_DIRECTORY);
  if (fsync(folder.get()) != 0 && errno != EINVAL) fail(path, "fsync of the folder", errno);  // EINVAL: it cannot
}

void discard(const std::string& path) noexcept { ::unlink(path.c_str()); }

void write_whole(const std::string& path, std::string_view text) {
  const std::string temporary = path + ".tmp";
  try {
    Descriptor file = Descriptor::create(temporary);
    file.write_at(std::as_bytes(std::span(text)), 0);
    file.close();
    commit(temporary, path);
  } catch (const Error&) {
    discard(temporary);
    throw;
  }
}

}  // namespace packmpi::disk
