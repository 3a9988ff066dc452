#include "disk/text_file.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>
#include <vector>

#include "disk/files.hpp"

namespace packmpi::disk {
namespace {

/// Makes `folder` and what is missing above it; what was made, innermost first.
std::vector<std::filesystem::path> make_folders(const std::filesystem::path& folder) {
  std::error_code code;
  std::vector<std::filesystem::path> missing;
  for (auto at = folder; !at.empty() && !std::filesystem::exists(at, code); at = at.parent_path())
    missing.push_back(at);
  std::filesystem::create_directories(folder, code);
  if (code) fail(folder.string(), "cannot make the folder", code.value());
  return missing;
}

void check_here(const std::filesystem::path& folder, std::int64_t bytes) {
  const std::vector<std::filesystem::path> made = make_folders(folder);
  // Named by the process: the groups of an ensemble look into one folder at the same time.
  const std::string probe = (folder / fmt::format(".packmpi-probe.{}.tmp", getpid())).string();
  try {
    reserve(probe, bytes);
  } catch (const Error&) {
    std::error_code ignored;
    for (const auto& one : made) std::filesystem::remove(one, ignored);  // empty ones only
    throw;
  }
  discard(probe);
}

}  // namespace

void check_writable(const comm::Comm& comm, const std::string& folder, std::int64_t bytes) {
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0) return;
    std::filesystem::path clean = std::filesystem::path(folder.empty() ? "." : folder).lexically_normal();
    if (!clean.has_filename()) clean = clean.parent_path();  // "out/" is "out"
    check_here(clean, bytes);
  });
}

void write_text(const comm::Comm& comm, const std::string& path, const std::string& text) {
  comm::agree_on(comm, [&] {
    if (comm.rank() == 0) write_whole(path, text);
  });
}

}  // namespace packmpi::disk
