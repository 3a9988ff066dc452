#include "output/files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "base/error.hpp"

namespace packmpi::output {
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

void reserve_open(const Descriptor& file, const std::string& path, std::int64_t bytes, int mode) {
  if (bytes <= 0 || fallocate(file.get(), mode, 0, bytes) == 0) return;
  const int number = errno;
  const bool unsupported = number == EOPNOTSUPP || number == ENOSYS || number == EINVAL;
  if (unsupported && free_bytes(path) >= bytes) return;
  const int shown = unsupported ? ENOSPC : number;
  fail(path, fmt::format("{:.1f} MB needed", static_cast<double>(bytes) * 1e-6), shown);
}

}  // namespace

void fail(const std::string& path, std::string_view what, int number) {
  throw Error(ExitCode::io_failure, fmt::format("cannot write {}: {}: {}", path, what, reason(number)));
}

Descriptor::Descriptor(const std::string& path, int flags)
    : path_(path), fd_(::open(path.c_str(), flags | O_CLOEXEC, file_mode)) {
  if (fd_ < 0) fail(path, "open", errno);
}

Descriptor::~Descriptor() {
  if (fd_ >= 0) ::close(fd_);
}

void Descriptor::close() {
  const int closed = ::close(fd_);
  fd_ = -1;
  if (closed != 0) fail(path_, "close", errno);
}

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

void reserve(const std::string& path, std::int64_t bytes) {
  Descriptor file(path, O_WRONLY | O_CREAT | O_TRUNC);
  try {
    reserve_open(file, path, bytes, 0);  // with the size, so that limits on it are met too
  } catch (const Error&) {
    discard(path);
    throw;
  }
  file.close();
}

void reserve_existing(const std::string& path, std::int64_t bytes) {
  Descriptor file(path, O_WRONLY);
  reserve_open(file, path, bytes, FALLOC_FL_KEEP_SIZE);
  file.close();
}

std::string diagnose(const std::string& path) {
  constexpr std::int64_t nearly_nothing = 1 << 16;
  if (free_bytes(path) < nearly_nothing) return reason(ENOSPC);
  if (access(folder_of(path).c_str(), W_OK) != 0) return reason(errno);
  return {};
}

void commit(const std::string& temporary, const std::string& path) {
  Descriptor file(temporary, O_WRONLY);
  if (fsync(file.get()) != 0) fail(path, "fsync", errno);
  file.close();
  if (std::rename(temporary.c_str(), path.c_str()) != 0) fail(path, "rename", errno);
  Descriptor folder(folder_of(path), O_RDONLY | O_DIRECTORY);
  if (fsync(folder.get()) != 0 && errno != EINVAL) fail(path, "fsync of the folder", errno);  // EINVAL: it cannot
}

void discard(const std::string& path) noexcept { ::unlink(path.c_str()); }

void write_whole(const std::string& path, std::string_view text) {
  const std::string temporary = path + ".tmp";
  try {
    Descriptor file(temporary, O_WRONLY | O_CREAT | O_TRUNC);
    while (!text.empty()) {
      const ssize_t written = ::write(file.get(), text.data(), text.size());
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) fail(path, "write", written == 0 ? ENOSPC : errno);
      text.remove_prefix(static_cast<std::size_t>(written));
    }
    file.close();
    commit(temporary, path);
  } catch (const Error&) {
    discard(temporary);
    throw;
  }
}

}  // namespace packmpi::output
