#include "cli/tools.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>

#include "base/error.hpp"
#include "comm/session.hpp"

namespace packmpi::cli {
namespace {

constexpr std::array<std::string_view, 3> tools{"render", "plot", "report"};

// The package's main file: where cmake --install puts it, or the link that stands in the build folder.
std::optional<std::string> find_package(const std::filesystem::path& folder) {
  for (const char* place : {PACKMPI_PYTHON_FROM_PROGRAM, "python"}) {
    const auto file = (folder / place / "packmpi" / "__main__.py").lexically_normal();
    std::error_code ignored;
    if (std::filesystem::exists(file, ignored)) return file.string();
  }
  return std::nullopt;
}

// Debian's own Python has Debian's packages; another one in PATH may not have them.
std::string python() {
  if (const char* chosen = std::getenv("PACKMPI_PYTHON")) return chosen;
  constexpr const char* of_debian = "/usr/bin/python3";
  return access(of_debian, X_OK) == 0 ? of_debian : "python3";
}

int fail(const char* tool, const std::string& words) {
  fmt::print(stderr, "packmpi {}: {}\n", tool, words);
  return static_cast<int>(ExitCode::io_failure);
}

}  // namespace

bool wants_tool(int argc, const char* const* argv) {
  return argc > 1 && std::ranges::find(tools, argv[1]) != tools.end() && !comm::launched();
}

int start_tool(int argc, const char* const* argv) {
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  const std::optional<std::string> package = find_package(program.parent_path());
  if (!package) {
    return fail(argv[1],
                fmt::format("its Python package is not there, neither {} nor python/packmpi beside {}; build or "
                            "install packmpi anew",
                            PACKMPI_PYTHON_FROM_PROGRAM "/packmpi", program.string()));
  }
  std::vector<std::string> words{python(), *package, argv[1], "--program", program.string()};
  words.insert(words.end(), argv + 2, argv + argc);
  std::vector<char*> pointers;  // as execvp wants them
  pointers.reserve(words.size() + 1);
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execvp(pointers.front(), pointers.data());
  return fail(argv[1],
              fmt::format("cannot start {}: {}; on Debian: apt-get install python3 python3-h5py python3-matplotlib",
                          words.front(), std::strerror(errno)));
}

}  // namespace packmpi::cli
