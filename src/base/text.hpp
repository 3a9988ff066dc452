/// Words for people: suggestions for misspelt names, durations, sizes.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace packmpi::text {

/// The least number of letters inserted, removed, exchanged, or swapped with their neighbour that turns a into b
/// (optimal string alignment). Case counts. Cost: O(|a| |b|).
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate nearest to `word`, for "did you mean ...?"; the first of equals. None when all are further away than
/// a third of the longer word's letters (at least one edit is always allowed), which would be a guess.
[[nodiscard]] std::optional<std::string> closest(std::string_view word, std::span<const std::string> candidates);

/// "0.42 s", "12.3 s", "4 min 05 s", "3 h 07 min", "2 d 05 h"; "unknown" for anything negative or not finite.
[[nodiscard]] std::string duration(double seconds);

/// "512 B", "1.5 KiB", "2.0 GiB": powers of 1024.
[[nodiscard]] std::string bytes(std::uint64_t count);

/// `text` without the blanks and tabs at its ends; a part of it, not a copy.
[[nodiscard]] std::string_view trimmed(std::string_view text) noexcept;

/// Bytes of the UTF-8 character that `text`, which is not empty, begins with; 0 if it begins with none.
[[nodiscard]] std::size_t utf8_length(std::string_view text) noexcept;

/// `text` on one line, and without what a terminal would obey: control characters (U+0000 to U+001F, U+007F to U+009F),
/// characters that turn or end a line elsewhere (U+2028 to U+202E, U+2066 to U+2069) and bytes that are no UTF-8, as
/// '?'.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace packmpi::text
