/// What the program says while it runs: to the terminal and to the log file.
#pragma once
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "base/types.hpp"

namespace packmpi::log {

/// How much rank 0 says on stderr.
enum class Verbosity { quiet, normal, verbose };

/// Lines of the log file: words, or one JSON object a line with the members time (ISO 8601), level, event ("message" if
/// it has no fields), text, and the fields.
enum class Format { text, jsonl };

/// A number or word that belongs to a line, for programs. SI units.
struct Field {
  std::string_view name;
  std::variant<std::int64_t, double, std::string> value;
};

/// Sets where words go. Rank 0: stderr from warnings (quiet), information (normal) or details (verbose) up, and `file`,
/// if given, gets all of it, appended, in `format`. Other ranks: warnings on stderr, with the rank; they open no file.
/// Before the first call a process speaks as a quiet rank 0; another call replaces the former.
/// Errors: Error(io_failure) when the file cannot be opened (on rank 0 only: call it inside comm::agree_on). Local.
void start(Rank rank, const std::optional<std::string>& file, Verbosity verbosity, Format format = Format::text);

/// Closes the file; the process speaks as before start(). Local.
void finish();

// A line each; local. Lines of `info` and above are flushed to the file at once, so a killed job leaves its log.
void debug(std::string_view text);
void info(std::string_view text);
void warn(std::string_view text);
void error(std::string_view text);

/// A line of `info` with what it says as fields, named `event` ("layer_settled"). Local.
void event(std::string_view event, std::string_view text, std::initializer_list<Field> fields);
/// The same for a file of JSON lines only: what the terminal shows otherwise (progress). Local.
void event_for_programs(std::string_view event, std::initializer_list<Field> fields);

}  // namespace packmpi::log
