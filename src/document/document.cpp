#include "document/document.hpp"

#include <fmt/format.h>

// toml++ 3.3 asserts that a table's name begins like one before it complains that it does not ("[[ = 1"). Debian's
// library is built without assertions; where the header is compiled in, they must not end the program either.
#define TOML_ASSERT(condition) static_cast<void>(0)
#include <toml++/toml.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "tables/units.hpp"

namespace packmpi::document {
namespace {

constexpr int most_dots = 16;  // in one key; toml++ recurses on them, and ours have two

/// Refuses what toml++ should not be asked to read.
void check_size(const std::string& text, const std::string& file) {
  const auto refuse = [&](std::int64_t line, std::string_view words) {
    throw Error(ExitCode::bad_input, fmt::format("{}:{}: {}", file, line, words));
  };
  if (text.empty()) refuse(1, "the file is empty; see doc/input.md for a first scene");
  if (text.size() > Document::longest_file) refuse(1, "the file is longer than 4 MiB; is it a scene?");
  int dots = 0;
  char before = '\n';  // the last character that is not a blank
  bool blank = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == ' ' || c == '\t') {
      blank = true;
      continue;
    }
    const bool new_word = (blank && before != '.') || std::string_view("=,[{#\n").find(c) != std::string_view::npos;
    if (c == '.') {
      dots = before == '.' ? 0 : dots + 1;
    } else if (new_word) {
      dots = 0;
    }
    if (dots > most_dots)
      refuse(1 + std::count(text.data(), text.data() + i, '\n'), "a key of too many parts; no key has more than three");
    before = c;
    blank = false;
  }
}

/// toml++'s words on one line: it quotes what it found, line ends included.
std::string one_line(std::string_view words) {
  std::string text(words);
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return text;
}

/// toml++'s tree into ours. `at` makes a place of a line number.
template <class Place>
Node convert(const toml::node& from, std::string place, const Place& at) {
  Node to{std::move(place), {}};
  if (const auto* table = from.as_table()) {
    Table entries;
    for (const auto& [key, node] : *table) {
      entries.push_back({std::string(key.str()), convert(node, at(key.source().begin.line), at)});
    }
    to.value = std::move(entries);
  } else if (const auto* array = from.as_array()) {
    List items;
    for (const auto& node : *array) items.push_back(convert(node, at(node.source().begin.line), at));
    to.value = std::move(items);
  } else if (const auto* text = from.as_string()) {
    to.value = text->get();
  } else if (const auto* whole = from.as_integer()) {
    to.value = whole->get();
  } else if (const auto* real = from.as_floating_point()) {
    to.value = real->get();
  } else if (const auto* flag = from.as_boolean()) {
    to.value = flag->get();
  } else {
    to.value = Date{};
  }
  return to;
}

Entry* find_entry(Table& table, std::string_view name) {
  const auto found = std::ranges::find(table, name, &Entry::name);
  return found == table.end() ? nullptr : &*found;
}

constexpr std::string_view command_line = "--set ";

/// Takes the part of `path` before the next dot off its front.
std::string_view next_name(std::string_view& path) {
  const std::size_t dot = std::min(path.find('.'), path.size());
  const std::string_view name = text::trimmed(path.substr(0, dot));
  path.remove_prefix(std::min(dot + 1, path.size()));
  return name;
}

}  // namespace

Document::Document(const std::string& text, const std::string& file) {
  check_size(text, file);
  try {
    root_ = convert(toml::parse(text), file + ":1", [&](auto line) { return fmt::format("{}:{}", file, line); });
  } catch (const toml::parse_error& error) {
    throw Error(ExitCode::bad_input, fmt::format("{}:{}: not TOML: {}; correct this line (toml.io tells the syntax)",
                                                 file, error.source().begin.line, one_line(error.description())));
  }
}

void Document::set(const std::string& assignment) {
  const bool prints = std::ranges::none_of(assignment, [](unsigned char c) { return c < 0x20 || c == 0x7f; });
  const std::string place = std::string(command_line) + (prints ? assignment : tables::toml_string(assignment));
  const std::size_t equals = assignment.find('=');
  std::string_view path = text::trimmed(std::string_view(assignment).substr(0, equals));
  if (equals == std::string::npos || path.empty() || path.ends_with('.')) {
    throw Error(ExitCode::bad_input, place + ": not an assignment; write --set key.path=value");
  }
  put(path, parse_value(std::string(text::trimmed(std::string_view(assignment).substr(equals + 1))), place));
}

void Document::put(std::string_view path, Node value) {
  Node* node = &root_;
  while (!path.empty()) {
    const std::string name(next_name(path));
    if (!std::holds_alternative<Table>(node->value)) *node = {value.place, Table{}};
    auto& table = std::get<Table>(node->value);
    Entry* entry = find_entry(table, name);
    node = entry != nullptr ? &entry->node : &table.emplace_back(Entry{name, {value.place, Table{}}}).node;
  }
  *node = std::move(value);
}

void Document::erase(std::string_view path) {
  Table* table = std::get_if<Table>(&root_.value);
  while (table != nullptr) {
    const std::string_view name = next_name(path);
    if (path.empty()) std::erase_if(*table, [&](const Entry& entry) { return entry.name == name; });
    Entry* entry = path.empty() ? nullptr : find_entry(*table, name);
    table = entry == nullptr ? nullptr : std::get_if<Table>(&entry->node.value);
  }
}

std::optional<Node> Document::take(std::string_view path) {
  const Node* node = find(path);
  if (node == nullptr) return std::nullopt;
  Node taken = *node;
  erase(path);
  return taken;
}

bool Document::rename(std::string_view path, const std::string& name) {
  Table* table = std::get_if<Table>(&root_.value);
  while (table != nullptr) {
    Entry* entry = find_entry(*table, next_name(path));
    if (entry != nullptr && path.empty()) entry->name = name;
    if (entry == nullptr || path.empty()) return entry != nullptr;
    table = std::get_if<Table>(&entry->node.value);
  }
  return false;
}

const Node* Document::find(std::string_view path) const {
  const Node* node = &root_;
  while (!path.empty()) {
    const std::string_view name = next_name(path);
    const auto* table = std::get_if<Table>(&node->value);
    if (table == nullptr) return nullptr;
    const auto found = std::ranges::find(*table, name, &Entry::name);
    if (found == table->end()) return nullptr;
    node = &found->node;
  }
  return node;
}

const std::string& Document::place(std::string_view path) const {
  while (!path.empty()) {
    if (const Node* node = find(path)) return node->place;
    path = path.substr(0, path.find('.') == std::string_view::npos ? 0 : path.rfind('.'));
  }
  return root_.place;
}

bool is_override(const Node& node) { return node.place.starts_with(command_line); }

Node parse_value(const std::string& text, const std::string& place) {
  try {
    const toml::table parsed = toml::parse("v = " + text);
    if (parsed.size() == 1) return convert(*parsed.get("v"), place, [&](auto) { return place; });
  } catch (const toml::parse_error&) {  // then it is a bare word, unless it was meant to be TOML
  }
  if (!text.empty() && text.find_first_of("[{\"'") == 0) {
    throw Error(ExitCode::bad_input, place + ": the value is not TOML; check its quotes and brackets");
  }
  return {place, text};
}

std::string describe(const Node& node) {
  struct {
    std::string operator()(const Table&) const { return "a table"; }
    std::string operator()(const List& list) const { return fmt::format("a list of {}", list.size()); }
    std::string operator()(const std::string& text) const {
      return tables::toml_string(text.size() <= 60 ? text : text.substr(0, 57) + "...");
    }
    std::string operator()(std::int64_t whole) const { return std::to_string(whole); }
    std::string operator()(double real) const { return tables::number(real); }
    std::string operator()(bool flag) const { return flag ? "true" : "false"; }
    std::string operator()(const Date&) const { return "a date"; }
  } const words;
  return std::visit(words, node.value);
}

void fail(std::string_view place, std::string_view path, std::string_view words) {
  throw Error(ExitCode::bad_input, fmt::format("{}: {}: {}", place, path, words));
}

}  // namespace packmpi::document
