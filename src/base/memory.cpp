#include "base/memory.hpp"

#include <fstream>
#include <limits>
#include <string>

namespace packmpi {

// Not getrusage: its maximum begins with that of the program that started this one.
std::int64_t memory_high_water() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word; status.ignore(std::numeric_limits<std::streamsize>::max(), '\n')) {
    std::int64_t kibibytes = 0;
    if (word == "VmHWM:" && status >> kibibytes) return kibibytes * 1024;
  }
  return 0;
}

}  // namespace packmpi
