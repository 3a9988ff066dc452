#include "base/patience.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "base/error.hpp"
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

[[noreturn]] void stop(const char* why) {
  throw Error(ExitCode::stopped_early,
              fmt::format("stopped while samples for [target] were made, before anything was written: {}; "
                          "the same command begins anew",
                          why));
}

}  // namespace

double seconds_allowed(double hours) { return std::min(hours > 0.0 ? hours * 3600.0 : no_limit, slurm_seconds()); }

Patience::Patience(std::string stop_file, double hours)
    : stop_file_(std::move(stop_file)), limit_(seconds_allowed(hours)) {}

void Patience::look() {
  if (stop_wished()) stop("a signal said so");
  const double now = watch_.seconds();
  if (now >= limit_) stop("the time limit is near");
  if (now - seen_at_ < file_interval) return;
  seen_at_ = now;
  std::error_code ignored;
  if (std::filesystem::exists(stop_file_, ignored)) stop("the STOP file is there");
}

}  // namespace packmpi
