#include "base/log.hpp"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <vector>

#include "base/error.hpp"

namespace packmpi::log {
namespace {

using Logger = std::shared_ptr<spdlog::logger>;

spdlog::level::level_enum terminal_level(Rank rank, Verbosity verbosity) {
  if (rank != 0 || verbosity == Verbosity::quiet) return spdlog::level::warn;
  return verbosity == Verbosity::normal ? spdlog::level::info : spdlog::level::debug;
}

spdlog::sink_ptr terminal(Rank rank, Verbosity verbosity) {
  auto sink = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  sink->set_level(terminal_level(rank, verbosity));
  sink->set_pattern(rank == 0 ? "%H:%M:%S %^%L%$ %v" : "%H:%M:%S %^%L%$ rank " + std::to_string(rank) + ": %v");
  return sink;
}

spdlog::sink_ptr file_sink(const std::string& file) {
  try {
    auto sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(file);
    sink->set_pattern("%Y-%m-%d %H:%M:%S.%e %l %v");
    return sink;
  } catch (const spdlog::spdlog_ex& failure) {
    throw Error(ExitCode::io_failure, "cannot write the log file: " + std::string(failure.what()));
  }
}

Logger make(Rank rank, const std::optional<std::string>& file, Verbosity verbosity) {
  std::vector<spdlog::sink_ptr> sinks{terminal(rank, verbosity)};
  if (rank == 0 && file) sinks.push_back(file_sink(*file));
  auto logger = std::make_shared<spdlog::logger>("packmpi", sinks.begin(), sinks.end());
  logger->set_level(spdlog::level::debug);
  logger->flush_on(spdlog::level::info);
  return logger;
}

Logger& current() {
  static Logger logger = make(0, std::nullopt, Verbosity::quiet);
  return logger;
}

}  // namespace

void start(Rank rank, const std::optional<std::string>& file, Verbosity verbosity) {
  current() = make(rank, file, verbosity);
}

void finish() { current() = make(0, std::nullopt, Verbosity::quiet); }

// The text is an argument, never a format: braces in a file name are harmless.
void debug(std::string_view text) { current()->debug("{}", text); }
void info(std::string_view text) { current()->info("{}", text); }
void warn(std::string_view text) { current()->warn("{}", text); }
void error(std::string_view text) { current()->error("{}", text); }

}  // namespace packmpi::log
