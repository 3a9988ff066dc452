/// Files that appear whole or not at all, with the system's own words when they cannot. Rank-local; private to this
/// module.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace packmpi::disk {

/// An open file or folder, closed on every path. A file is a regular one and PATH its own name: neither symbolic links
/// nor FIFOs and devices are followed, so that nothing that lies in a folder makes us write to another place, or wait.
class Descriptor {
 public:
  Descriptor(const std::string& path, int flags);  ///< one that is there; throws Error(io_failure)
  /// A new file, empty, for writing. What a killed run or a link left under this name goes first; a folder, FIFO or
  /// device is refused. Throws Error(io_failure).
  [[nodiscard]] static Descriptor create(const std::string& path);
  ~Descriptor();
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const noexcept { return fd_; }
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  void write_at(std::span<const std::byte> bytes, std::int64_t at);  ///< all of them; throws Error(io_failure)
  void sync();                                                       ///< fsync; throws Error(io_failure)
  /// Close now; a delayed write error is thrown as Error(io_failure).
  void close();

 private:
  std::string path_;
  int fd_;
};

/// Throws Error(io_failure): "cannot write PATH: WHAT: REASON", the reason of the errno `number`.
[[noreturn]] void fail(const std::string& path, std::string_view what, int number);

/// Make PATH a file without contents of which `bytes` are already on the disk (where the file system can promise that;
/// elsewhere the free space is compared), so that a full disk is met here and not in the middle of a collective write.
void reserve(const std::string& path, std::int64_t bytes);

/// A file in memory. Only what was written takes any.
class MemoryFile {
 public:
  /// Throws Error(io_failure), as writing `for_what` would.
  explicit MemoryFile(const std::string& for_what);
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  /// Throws Error(io_failure) unless it may grow to `bytes`: HDF5 must not meet the process' limit on files (ulimit
  /// -f), as a file that it cannot close ends the program at its exit. Takes no memory.
  void expect(std::int64_t bytes, const std::string& for_what) const;
  /// The open file `fd` of this process is this one from now on. False: it cannot be.
  [[nodiscard]] bool stand_in_for(int fd) const noexcept;
  [[nodiscard]] std::int64_t size() const;  ///< [bytes], holes included; throws Error(io_failure)
  /// Makes `disk` as long as this file, its space on the disk, and writes to it what was written here.
  void copy_to(Descriptor& disk) const;
  /// Holes are zeros. Throws Error(io_failure).
  [[nodiscard]] std::string read(std::int64_t begin, std::int64_t size) const;

 private:
  int fd_;
};

/// TEMPORARY becomes PATH, on the disk to stay: fsync, rename, fsync of the folder.
void commit(const std::string& temporary, const std::string& path);

/// Remove PATH if it is there.
void discard(const std::string& path) noexcept;

/// Write `text` whole: temporary, fsync, rename. On failure PATH is as it was.
void write_whole(const std::string& path, std::string_view text);

/// The folder of a path, "." if none is named.
[[nodiscard]] std::string folder_of(const std::string& path);

}  // namespace packmpi::disk
