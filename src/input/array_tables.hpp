/// Arrays of tables, such as [[component]], which the key table has not.
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "document/document.hpp"
#include "input/keys.hpp"
#include "input/values.hpp"

namespace packmpi::input {

using document::Document;
using document::Node;

inline constexpr Range from_zero{0.0, std::numeric_limits<double>::infinity(), false, false};
inline constexpr Range above_zero{0.0, std::numeric_limits<double>::infinity(), true, false};

[[nodiscard]] bool is_in(std::span<const std::string_view> names, std::string_view name);

/// The entries of a node that is a table.
[[nodiscard]] const document::Table& table_of(const Node& node);
/// The one of this name, or null.
[[nodiscard]] const Node* entry(const Node& table, std::string_view name);

/// Takes the tables [[name]] out of the document; none if it has none. Throws Error(bad_input).
[[nodiscard]] std::vector<Node> tables_at(Document& document, std::string_view name);

/// Throws Error(bad_input) if a table [[what]] has another entry than `names`.
void refuse_unknown_in(const Node& table, std::string_view what, std::span<const std::string_view> names);

/// Stores a value as store() does, in a member that no table of keys has: `key` says all but where it goes.
template <class Value>
void store_in(Value& value, Key key, const Node& node) {
  Input none;
  key.slot = [&value](Input&) -> Slot { return &value; };
  store(key, node, none);
}

/// A number under a key that no table has.
[[nodiscard]] double number_at(std::string_view path, const Node& node, const Quantity& quantity, Range range);

}  // namespace packmpi::input
