/// What the program says while it runs: to the terminal and to the log file.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "base/types.hpp"

namespace packmpi::log {

/// How much rank 0 says on stderr.
enum class Verbosity { quiet, normal, verbose };

/// Sets where words go. Rank 0: stderr from warnings (quiet), information (normal) or details (verbose) up, and `file`,
/// if given, gets all of it, appended. Other ranks: warnings on stderr, with the rank; they open no file.
/// Before the first call a process speaks as a quiet rank 0; another call replaces the former.
/// Errors: Error(io_failure) when the file cannot be opened (on rank 0 only: call it inside comm::agree_on). Local.
void start(Rank rank, const std::optional<std::string>& file, Verbosity verbosity);

/// Closes the file; the process speaks as before start(). Local.
void finish();

// A line each; local. Lines of `info` and above are flushed to the file at once, so a killed job leaves its log.
void debug(std::string_view text);
void info(std::string_view text);
void warn(std::string_view text);
void error(std::string_view text);

}  // namespace packmpi::log
