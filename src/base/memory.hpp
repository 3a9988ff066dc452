/// How much memory a process has needed, and what is said when there is no more.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <string>

namespace packmpi {

/// The most memory this process has had resident since its start [B], of Linux's /proc; libraries are in it. 0 where it
/// cannot be read. Local.
[[nodiscard]] std::int64_t memory_high_water();

/// Memory that the system did not give. what(): "memory exhausted: 1.2 GiB wanted by the insertion of a layer".
class OutOfMemory : public std::bad_alloc {
 public:
  explicit OutOfMemory(std::size_t bytes) noexcept;
  [[nodiscard]] const char* what() const noexcept override { return words_.data(); }

 private:
  std::array<char, 160> words_{};
};

/// Names what this process is at, for OutOfMemory, while it lives; then what was before holds again. Local; one thread.
class Occupation {
 public:
  explicit Occupation(const char* words) noexcept;  ///< "the insertion of a layer"; they must live as long
  ~Occupation();
  Occupation(const Occupation&) = delete;
  Occupation& operator=(const Occupation&) = delete;

 private:
  const char* before_;
};

/// What the scene at work is going to take of a rank's memory [B], for memory_words(); 0: not known. Local.
void expect_memory(std::int64_t bytes_a_rank) noexcept;

/// One line for the user: the bytes wanted and by what, what this process holds, the scene's share, what to change.
[[nodiscard]] std::string memory_words(const std::bad_alloc& failure);

}  // namespace packmpi
