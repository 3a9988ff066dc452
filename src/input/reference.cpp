#include <fmt/format.h>

#include <string>

#include "document/document.hpp"
#include "input/keys.hpp"
#include "input/read.hpp"

namespace packmpi::input {

using document::describe;
using document::parse_value;

namespace {

/// Text for a cell of a Markdown table.
std::string cell(std::string text) {
  for (std::size_t at = text.find('|'); at != std::string::npos; at = text.find('|', at + 2)) text.insert(at, 1, '\\');
  return text;
}

/// A list whose default is that of each of its entries.
bool many(const Key& key) { return key.count != Count::one && key.count != Count::any; }

std::string default_cell(const Key& key) {
  if (!key.standard) return "**mandatory**";
  if (key.standard->starts_with('[')) return fmt::format("`{}`", *key.standard);
  if (key.standard->starts_with('=')) return fmt::format("as `{}`", key.standard->substr(1));
  return fmt::format("{}`{}`", many(key) ? "each " : "", describe(parse_value(std::string(*key.standard), "default")));
}

std::string value_cell(const Key& key) {
  switch (key.count) {
    case Count::axes:
      return "2D: list of 2, 3D: list of 3; each " + wanted(key);
    case Count::lateral_axes:
      return "2D: list of 1, 3D: list of 2; each " + wanted(key);
    case Count::spin_axes:
      return "2D: list of 1, 3D: list of 3; each " + wanted(key);
    case Count::two:
      return "list of 2; each " + wanted(key);
    case Count::any:
      return "list; each " + wanted(key);
    case Count::one:
      break;
  }
  return wanted(key);
}

std::string doc_cell(const Key& key) {
  std::string text(key.doc);
  if (!key.when.words.empty()) text += fmt::format(" Only if {}.", key.when.words);
  if (key.only) text += fmt::format(" Only {:g} is available in this version.", *key.only);
  return text;
}

}  // namespace

std::string reference() {
  std::string text, open = "none yet";
  for (const Key& key : keys()) {
    const std::size_t dot = key.path.rfind('.');
    const std::string table(dot == std::string_view::npos ? "" : key.path.substr(0, dot));
    if (table != open) {
      text += table.empty() ? "### Above all tables\n" : fmt::format("\n### `[{}]`\n", table);
      text += "\n| key | value | default | meaning |\n|---|---|---|---|\n";
    }
    open = table;
    const std::string_view name = key.path.substr(dot + 1);  // npos + 1 is 0
    text += fmt::format("| `{}` | {} | {} | {} |\n", name, cell(value_cell(key)), cell(default_cell(key)),
                        cell(doc_cell(key)));
  }
  return text;
}

}  // namespace packmpi::input
