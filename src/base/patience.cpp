#include "base/patience.hpp"

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "base/signals.hpp"

namespace packmpi {
namespace {

constexpr double slurm_reserve = 10.0;  // [s] for the end of the program
constexpr double no_limit = std::numeric_limits<double>::infinity();
constexpr double file_interval = 1.0;  // [s] between looks for the STOP file

double slurm_seconds() {
  const char* end = std::getenv("SLURM_JOB_END_TIME");
  if (end == nullptr) return no_limit;
  const double at = std::strtod(end, nullptr);
  return at > 0.0 ? at - static_cast<double>(std::time(nullptr)) - slurm_reserve : no_limit;
}

}  // namespace

double seconds_allowed(double hours) { return std::min(hours > 0.0 ? hours * 3600.0 : no_limit, slurm_seconds()); }

StopFile::StopFile(std::string path) : path_(std::move(path)) {}

bool StopFile::is_there() {
  const double now = watch_.seconds();
  if (now - seen_at_ < file_interval) return false;
  seen_at_ = now;
  std::error_code ignored;
  return std::filesystem::exists(path_, ignored);
}

Patience::Patience(const std::string& stop_file, double hours)
    : stop_file_(stop_file), limit_(seconds_allowed(hours)) {}

const char* Patience::why_to_end() {
  if (stop_wished()) return "a signal said so";
  if (watch_.seconds() >= limit_) return "the time limit is near";
  return stop_file_.is_there() ? "the STOP file is there" : nullptr;
}

}  // namespace packmpi
