#include "library/failure.hpp"

#include <algorithm>
#include <charconv>

namespace packmpi::library {
namespace {

bool is_key(std::string_view word) {
  return !word.empty() && std::ranges::all_of(word, [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.' ||
           c == '-' || c == '"';
  });
}

/// What stands before the first ": " of `rest`, and takes it away; "" if it is no key.
std::string take_key(std::string_view& rest) {
  const std::size_t end = rest.find(": ");
  if (end == std::string_view::npos || !is_key(rest.substr(0, end))) return "";
  std::string key(rest.substr(0, end));
  rest.remove_prefix(end + 2);
  return key;
}

}  // namespace

Failure failure_of(const comm::Failure& failure, const std::string& scene_file) {
  const int code = static_cast<int>(failure.code);
  std::string_view rest = failure.words;
  constexpr std::string_view set = "--set ";  // "--set KEY=VALUE: KEY: ...": a change of the scene, which has no line
  if (rest.starts_with(set)) {
    const std::string_view change = rest.substr(set.size());
    const std::string key(change.substr(0, change.find('=')));
    return {code, failure.words, scene_file, 0, is_key(key) ? key : ""};
  }
  if (scene_file.empty() || !rest.starts_with(scene_file + ":")) return {code, failure.words};
  rest.remove_prefix(scene_file.size() + 1);
  std::int64_t line = 0;
  const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), line);
  if (error == std::errc() && rest.substr(static_cast<std::size_t>(end - rest.data())).starts_with(": ")) {
    rest.remove_prefix(static_cast<std::size_t>(end - rest.data()) + 2);
  } else {
    line = 0;
    rest.remove_prefix(std::min<std::size_t>(rest.find_first_not_of(' '), rest.size()));
  }
  return {code, failure.words, scene_file, line, take_key(rest)};
}

}  // namespace packmpi::library
