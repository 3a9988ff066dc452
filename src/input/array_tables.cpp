#include "input/array_tables.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/text.hpp"
#include "tables/known_names.hpp"

namespace packmpi::input {

using document::Entry;
using document::List;
using document::Table;

bool is_in(std::span<const std::string_view> names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

const Table& table_of(const Node& node) { return std::get<Table>(node.value); }

const Node* entry(const Node& table, std::string_view name) {
  const auto found = std::ranges::find(table_of(table), name, &Entry::name);
  return found == table_of(table).end() ? nullptr : &found->node;
}

std::vector<Node> tables_at(Document& document, std::string_view name) {
  std::optional<Node> node = document.take(name);
  if (!node) return {};
  auto* list = std::get_if<List>(&node->value);
  const bool tables = list != nullptr && std::ranges::all_of(*list, [](const Node& item) {
                        return std::holds_alternative<Table>(item.value);
                      });
  if (!tables) {
    document::fail(node->place, name,
                   fmt::format("is {}; write [[{}]] above each of them", document::describe(*node), name));
  }
  return std::move(*list);
}

void refuse_unknown_in(const Node& table, std::string_view what, std::span<const std::string_view> names) {
  for (const Entry& item : table_of(table)) {
    if (is_in(names, item.name)) continue;
    std::optional<std::string> words = tables::known_elsewhere(what, item.name);
    if (!words) {
      const auto near = text::closest(item.name, std::vector<std::string>(names.begin(), names.end()));
      words =
          near ? fmt::format("did you mean \"{}\"?", *near) : fmt::format("[[{}]] has {}", what, joined(names, "and"));
    }
    document::fail(item.node.place, fmt::format("{}.{}", what, tables::toml_string(item.name)),
                   fmt::format("unknown key; {}", *words));
  }
}

double number_at(std::string_view path, const Node& node, const Quantity& quantity, Range range) {
  double value = 0.0;
  Key key{.path = path, .slot = {}, .quantity = &quantity, .unit = quantity.si, .range = range};
  store_in(value, key, node);
  return value;
}

}  // namespace packmpi::input
