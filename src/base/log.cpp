#include "base/log.hpp"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/error.hpp"
#include "base/regular_file.hpp"
#include "base/text.hpp"

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

// Words as they are, or the members of a JSON object made by line().
constexpr const char* text_pattern = "%Y-%m-%d %H:%M:%S.%e %l %v";
constexpr const char* jsonl_pattern = R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","level":"%l",%v})";

spdlog::sink_ptr file_sink(const std::string& file, Format format) {
  struct stat there {};
  const std::string flaw = lstat(file.c_str(), &there) == 0 ? kind_flaw(there.st_mode) : "";
  if (!flaw.empty())
    throw Error(ExitCode::io_failure, "cannot write the log file: " + file + " " + flaw + "; remove it");
  try {
    auto sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(file);
    sink->set_pattern(format == Format::jsonl ? jsonl_pattern : text_pattern);
    return sink;
  } catch (const spdlog::spdlog_ex& failure) {
    throw Error(ExitCode::io_failure, "cannot write the log file: " + std::string(failure.what()));
  }
}

Logger make(const spdlog::sink_ptr& sink) {
  auto logger = std::make_shared<spdlog::logger>("packmpi", sink);
  logger->set_level(spdlog::level::debug);
  logger->flush_on(spdlog::level::info);
  return logger;
}

struct Outlets {
  Logger terminal;
  Logger file;  // may be none
  Format format = Format::text;
};

Outlets& current() {
  static Outlets outlets{make(terminal(0, Verbosity::quiet)), nullptr, Format::text};
  return outlets;
}

using Fields = std::initializer_list<Field>;

// The members of the line's object, without its braces.
std::string members(std::string_view event, std::string_view text, Fields fields) {
  nlohmann::ordered_json line{{"event", event}};
  if (!text.empty()) line["text"] = text;
  for (const Field& field : fields) {
    std::visit([&](const auto& value) { line[std::string(field.name)] = value; }, field.value);
  }
  const std::string whole = line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  return whole.substr(1, whole.size() - 2);
}

// The text is an argument, never a format, and printable: braces and control characters in a file name are harmless.
void say(spdlog::level::level_enum level, std::string_view words, std::string_view event = "message",
         Fields fields = {}) {
  const Outlets& out = current();
  const std::string text = text::printable(words);
  out.terminal->log(level, "{}", text);
  if (!out.file) return;
  if (out.format == Format::jsonl) {
    out.file->log(level, "{}", members(event, words, fields));  // JSON has escapes of its own
  } else {
    out.file->log(level, "{}", text);
  }
}

}  // namespace

void start(Rank rank, const std::optional<std::string>& file, Verbosity verbosity, Format format) {
  current() = {make(terminal(rank, verbosity)), rank == 0 && file ? make(file_sink(*file, format)) : nullptr, format};
}

void finish() { current() = {make(terminal(0, Verbosity::quiet)), nullptr, Format::text}; }

void debug(std::string_view text) { say(spdlog::level::debug, text); }
void info(std::string_view text) { say(spdlog::level::info, text); }
void warn(std::string_view text) { say(spdlog::level::warn, text); }
void error(std::string_view text) { say(spdlog::level::err, text); }

void event(std::string_view event, std::string_view text, Fields fields) {
  say(spdlog::level::info, text, event, fields);
}

void event_for_programs(std::string_view event, Fields fields) {
  const Outlets& out = current();
  if (out.file && out.format == Format::jsonl) out.file->info("{}", members(event, "", fields));
}

}  // namespace packmpi::log
