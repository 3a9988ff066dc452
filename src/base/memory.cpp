#include "base/memory.hpp"

#include <cstdio>
#include <fstream>
#include <limits>
#include <string>

#include "base/text.hpp"

namespace packmpi {
namespace {

const char* occupation = "";
std::int64_t expected_bytes = 0;

}  // namespace

// Not getrusage: its maximum begins with that of the program that started this one.
std::int64_t memory_high_water() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word; status.ignore(std::numeric_limits<std::streamsize>::max(), '\n')) {
    std::int64_t kibibytes = 0;
    if (word == "VmHWM:" && status >> kibibytes) return kibibytes * 1024;
  }
  return 0;
}

OutOfMemory::OutOfMemory(std::size_t bytes) noexcept {  // nothing here may want memory itself
  constexpr double mebibyte = 1048576.0;
  const char* by = *occupation == '\0' ? "" : " by ";
  (void)std::snprintf(words_.data(), words_.size(), "memory exhausted: %zu bytes (%.1f MiB) wanted%s%s", bytes,
                      static_cast<double>(bytes) / mebibyte, by, occupation);
}

Occupation::Occupation(const char* words) noexcept : before_(occupation) { occupation = words; }

Occupation::~Occupation() { occupation = before_; }

void expect_memory(std::int64_t bytes_a_rank) noexcept { expected_bytes = bytes_a_rank; }

std::string memory_words(const std::bad_alloc& failure) {
  const bool ours = dynamic_cast<const OutOfMemory*>(&failure) != nullptr;
  std::string words = ours ? failure.what() : std::string("memory exhausted");
  if (!ours && *occupation != '\0') words += std::string(" by ") + occupation;
  words += "; this rank has held " + text::bytes(static_cast<std::uint64_t>(memory_high_water()));
  if (expected_bytes > 0) {
    words += ", the scene takes about " + text::bytes(static_cast<std::uint64_t>(expected_bytes)) + " of each rank";
  }
  return words +
         "; use fewer ranks a node on more nodes, a smaller container or larger particles (packmpi estimate "
         "tells what they take)";
}

}  // namespace packmpi
