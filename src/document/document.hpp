/// A scene file as a tree of values that know where they were written. The only door to toml++.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "tables/units.hpp"

namespace packmpi::document {

struct Entry;
struct Node;
using Table = std::vector<Entry>;  ///< in no particular order
using List = std::vector<Node>;
struct Date {};  ///< TOML has dates; no key takes one

struct Node {
  std::string place;  ///< "FILE:LINE" or "--set key=value"
  std::variant<Table, List, std::string, std::int64_t, double, bool, Date> value;
};

struct Entry {
  std::string name;
  Node node;
};

/// The tree and the questions asked of it.
class Document {
 public:
  static constexpr std::size_t longest_file = std::size_t{4}
                                              << 20;  ///< bytes; a scene is a page of text, or has a list of sizes

  /// Parses `text` as the file `file`. Throws Error(bad_input), one line, on anything that is not TOML.
  Document(const std::string& text, const std::string& file);

  /// Puts the value of "key.path=value" in place of what the file says. Throws Error(bad_input).
  void set(const std::string& assignment);

  /// Puts a value at "a.b", in place of what is there.
  void put(std::string_view path, Node value);
  /// Takes the entry at "a.b" out, if there is one.
  void erase(std::string_view path);
  /// The same, and gives its node away. Null: there is none.
  std::optional<Node> take(std::string_view path);

  /// Gives the entry at "a.b" the name `name`, in place. False: there is none.
  bool rename(std::string_view path, const std::string& name);

  [[nodiscard]] const Table& root() const { return std::get<Table>(root_.value); }
  /// The node at "a.b.c", or null.
  [[nodiscard]] const Node* find(std::string_view path) const;
  /// Where `path` is written, or the nearest table around it, or the first line.
  [[nodiscard]] const std::string& place(std::string_view path) const;

 private:
  Node root_;
};

/// Was it put there by the command line?
[[nodiscard]] bool is_override(const Node& node);

/// A TOML value from text; a bare word is a string. Throws Error(bad_input) beginning with `place`.
[[nodiscard]] Node parse_value(const std::string& text, const std::string& place);

/// The value for a message, on one line: "abc", 3, 0.5, a table, a list of 2.
[[nodiscard]] std::string describe(const Node& node);

/// Throws Error(bad_input) "place: path: words".
[[noreturn]] void fail(std::string_view place, std::string_view path, std::string_view words);

}  // namespace packmpi::document
