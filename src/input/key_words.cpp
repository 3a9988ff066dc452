/// What the key table says in words: for error messages and for the reference.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "config/words.hpp"
#include "input/keys.hpp"

namespace packmpi::input {
namespace {

/// The key's slot in an input of our own, to learn its type.
Slot sample(const Key& key) {
  thread_local Input any = [] {
    Input in;
    in.near_field.emplace();
    in.start.emplace();
    in.target.emplace();
    in.confinement.emplace();
    return in;
  }();
  return key.slot(any);
}

/// 3 rather than 3.0: bounds are read by people.
std::string bound(double value) { return fmt::format("{:.10g}", value); }

/// "a number > 0 [m]".
std::string a_number(std::string_view noun, const Key& key) {
  std::string text(noun);
  if (const std::string range = key.range.words(); !range.empty()) text += " " + range;
  if (!key.unit.empty()) text += fmt::format(" [{}]", key.unit);
  return text;
}

}  // namespace

bool Range::contains(double value) const noexcept {
  return std::isfinite(value) && (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Range::words() const {
  const std::string from = std::isfinite(low) ? fmt::format("{} {}", low_open ? ">" : ">=", bound(low)) : "";
  const std::string to = std::isfinite(high) ? fmt::format("{} {}", high_open ? "<" : "<=", bound(high)) : "";
  return from + (from.empty() || to.empty() ? "" : " and ") + to;
}

const Key* find_key(std::string_view path) {
  const auto found = std::ranges::find(keys(), path, &Key::path);
  return found == keys().end() ? nullptr : &*found;
}

std::size_t entries(const Key& key, const Input& in) {
  const auto dimension = static_cast<std::size_t>(in.container.dimension);
  switch (key.count) {
    case Count::axes:
      return dimension;
    case Count::lateral_axes:
      return dimension - 1;
    case Count::spin_axes:
      return dimension == 3 ? 3 : 1;
    case Count::two:
      return 2;
    case Count::any:
      return 0;
    case Count::one:
      break;
  }
  return 1;
}

std::vector<std::string_view> choices(const Key& key) {
  std::vector<std::string_view> words = key.choices;
  std::visit(
      [&](auto* target) {
        using Value = std::remove_pointer_t<decltype(target)>;
        if constexpr (std::is_enum_v<Value>) words.assign(words_of<Value>.begin(), words_of<Value>.end());
        if constexpr (std::is_same_v<Value, std::vector<Boundary>>) {
          words.assign(words_of<Boundary>.begin(), words_of<Boundary>.end());
        }
      },
      sample(key));
  return words;
}

std::string joined(std::span<const std::string_view> words, std::string_view last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? fmt::format(" {} ", last) : ", ";
    text += words[i];
  }
  return text;
}

std::string wanted(const Key& key) {
  std::vector<std::string> quotes;
  for (const std::string_view one : choices(key)) quotes.push_back(fmt::format("\"{}\"", one));
  if (!quotes.empty()) return joined(std::vector<std::string_view>(quotes.begin(), quotes.end()));
  const Slot slot = sample(key);
  if (key.path == "container.polygon") return "a corner of two numbers [m]";
  if (std::holds_alternative<Curve*>(slot)) return a_number("a pair: a diameter", key) + " and the percentage passing";
  if (std::holds_alternative<bool*>(slot)) return "true or false";
  if (std::holds_alternative<std::string*>(slot)) return "a text in quotes";
  if (std::holds_alternative<std::optional<double>*>(slot)) return a_number("a number", key) + " or \"auto\"";
  const bool is_whole = std::holds_alternative<int*>(slot) || std::holds_alternative<std::int64_t*>(slot) ||
                        std::holds_alternative<std::uint64_t*>(slot);
  if (is_whole && key.range.high == key.range.low + 1.0) return bound(key.range.low) + " or " + bound(key.range.high);
  return a_number(is_whole ? "a whole number" : "a number", key);
}

}  // namespace packmpi::input
