/// A file that one process at a time may hold: what keeps two runs from writing the same outputs.
#pragma once
#include <string>

namespace packmpi::disk {

/// A lock on a file (an open file description's lock, fcntl(2)). The kernel lets go of it when the process ends,
/// however that happens, so a run that died holds nothing, though its lock file may be left. Over NFS, and over other
/// network file systems mounted with locks, it holds between machines too; what a machine held that has gone down, the
/// server lets go of by its own rules (NFSv4: after the lease, a minute and a half).
class Lock {
 public:
  Lock() = default;  ///< holds nothing
  /// Takes `path`, which is made if it is missing and says who holds it. Rank-local. Throws Error(bad_input) if
  /// somebody else holds it, Error(io_failure) if it cannot be made or is no plain file. Where the file system has no
  /// locks nothing is held, and no file is left: see held().
  explicit Lock(const std::string& path);
  ~Lock();
  Lock(Lock&& other) noexcept;
  Lock& operator=(Lock&& other) noexcept;
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

  [[nodiscard]] bool held() const noexcept { return fd_ >= 0; }

 private:
  void release() noexcept;  // removes the file

  std::string path_;
  int fd_ = -1;
};

/// Throws as taking the lock `path` would if somebody holds it; changes nothing. Rank-local.
void refuse_if_locked(const std::string& path);

}  // namespace packmpi::disk
