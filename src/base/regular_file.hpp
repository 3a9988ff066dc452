/// Files that somebody else made, open for reading.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

namespace packmpi {

/// A regular file, open for reading, or the reason why there is none. Opening and reading never wait: a FIFO, a socket
/// or a device is refused. Rank-local. Closed on every path.
class RegularFile {
 public:
  explicit RegularFile(const std::string& path);
  ~RegularFile();
  RegularFile(const RegularFile&) = delete;
  RegularFile& operator=(const RegularFile&) = delete;

  /// "" if it is open; else what stands after its path in a complaint: "is a FIFO, not a regular file".
  [[nodiscard]] const std::string& flaw() const noexcept { return flaw_; }
  [[nodiscard]] std::int64_t size() const noexcept { return size_; }  ///< [bytes] when it was opened
  /// Bytes [begin, begin + size); fewer where the file ends. None: it cannot be read.
  [[nodiscard]] std::optional<std::string> read(std::int64_t begin, std::int64_t size) const;

 private:
  int fd_ = -1;
  std::int64_t size_ = 0;
  std::string flaw_;
};

/// What a path leads to, if it is not a regular file: "is a folder", "is a FIFO, not a regular file". "" for a regular
/// file and for what cannot be looked at. `mode` of stat(2).
[[nodiscard]] std::string kind_flaw(unsigned mode);

}  // namespace packmpi
