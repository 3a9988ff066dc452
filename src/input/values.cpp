#include "input/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <concepts>
#include <utility>

#include "base/text.hpp"
#include "config/words.hpp"
#include "tables/units.hpp"

namespace packmpi::input {

using document::describe;
using document::fail;
using document::List;
using document::parse_value;
using tables::toml_string;

namespace {

using tables::number, tables::parse_scalar, tables::Scalar;

/// One value on its way to its member: a key's own, or an entry of its list.
struct Arrival {
  const Key& key;
  const Node& node;
  const Input& in;
  std::string path;

  [[noreturn]] void refuse(const std::string& words) const { fail(node.place, path, words); }
  [[noreturn]] void want(const std::string& what) const { refuse(fmt::format("is {}; give {}", describe(node), what)); }
};

double ranged(const Arrival& arrival, double value) {
  const Key& key = arrival.key;
  if (!key.range.contains(value))
    arrival.refuse(fmt::format("{} is out of range; give {}", describe(arrival.node), wanted(key)));
  if (key.only && value != *key.only) {
    arrival.refuse(fmt::format("{} is not available in this version; use {:g}", describe(arrival.node), *key.only));
  }
  return value;
}

/// Lengths of the size distribution are radii in the program; the scene may give diameters.
bool is_diameter(const Arrival& arrival) {
  return arrival.in.particles.radius.diameters && arrival.key.path.starts_with("particles.radius.") &&
         arrival.key.quantity == &length && arrival.key.path != "particles.radius.diameter_curve";
}

void assign(const Arrival& arrival, double& to) {
  const auto& value = arrival.node.value;
  if (const auto* real = std::get_if<double>(&value)) {
    to = ranged(arrival, *real);
  } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
    to = ranged(arrival, static_cast<double>(*whole));
  } else if (const auto* text = std::get_if<std::string>(&value)) {
    const Scalar scalar = parse_scalar(*text, *arrival.key.quantity);
    if (!scalar.value) arrival.refuse(fmt::format("{} {}", describe(arrival.node), scalar.complaint));
    to = ranged(arrival, *scalar.value);
  } else {
    arrival.want(wanted(arrival.key));
  }
  if (is_diameter(arrival)) to *= 0.5;
}

void assign(const Arrival& arrival, std::optional<double>& to) {
  const auto* text = std::get_if<std::string>(&arrival.node.value);
  if (text != nullptr && *text == "auto") {
    to.reset();
    return;
  }
  if (std::holds_alternative<bool>(arrival.node.value)) arrival.want(wanted(arrival.key));
  double value = 0.0;
  assign(arrival, value);
  to = value;
}

template <std::integral Whole>
void assign(const Arrival& arrival, Whole& to) {
  const auto* whole = std::get_if<std::int64_t>(&arrival.node.value);
  if (whole == nullptr) arrival.want(wanted(arrival.key));
  ranged(arrival, static_cast<double>(*whole));
  to = static_cast<Whole>(*whole);
}

void assign(const Arrival& arrival, bool& to) {
  const auto* flag = std::get_if<bool>(&arrival.node.value);
  if (flag == nullptr) arrival.want(wanted(arrival.key));
  to = *flag;
}

/// The word as written, if it is one of the key's.
std::string_view chosen(const Arrival& arrival) {
  const auto* text = std::get_if<std::string>(&arrival.node.value);
  if (text == nullptr) arrival.want(wanted(arrival.key));
  const auto known = choices(arrival.key);
  const auto found = std::ranges::find(known, *text);
  if (found != known.end()) return *found;
  if (const auto near = text::closest(*text, std::vector<std::string>(known.begin(), known.end()))) {
    arrival.refuse(fmt::format("{} is not a choice; give {} (did you mean \"{}\"?)", describe(arrival.node),
                               wanted(arrival.key), *near));
  }
  arrival.refuse(fmt::format("{} is not a choice; give {}", describe(arrival.node), wanted(arrival.key)));
}

void assign(const Arrival& arrival, std::string& to) {
  const auto* text = std::get_if<std::string>(&arrival.node.value);
  if (text == nullptr) arrival.want(wanted(arrival.key));
  to = arrival.key.choices.empty() ? *text : std::string(chosen(arrival));
}

template <class Enum>
requires std::is_enum_v<Enum>
void assign(const Arrival& arrival, Enum& to) {
  const auto& words = words_of<Enum>;
  to = static_cast<Enum>(std::ranges::find(words, chosen(arrival)) - words.begin());
}

/// The entries of a list of the length this scene needs.
const List& entries_of(const Arrival& arrival) {
  const std::size_t count = entries(arrival.key, arrival.in);
  const auto* list = std::get_if<List>(&arrival.node.value);
  const auto need = [&] {
    if (count == 0) return fmt::format("a list, each {}", wanted(arrival.key));
    if (arrival.key.count == Count::two) return fmt::format("a list of 2, each {}", wanted(arrival.key));
    return fmt::format("a list of {} (container.dimension = {}), each {}", count, arrival.in.container.dimension,
                       wanted(arrival.key));
  };
  if (list == nullptr || (count > 0 && list->size() != count)) arrival.want(need());
  return *list;
}

Arrival entry(const Arrival& arrival, const List& list, std::size_t i) {
  return {arrival.key, list[i], arrival.in, fmt::format("{}[{}]", arrival.path, i)};
}

template <class Value>
void assign(const Arrival& arrival, std::vector<Value>& to) {
  const List& list = entries_of(arrival);
  std::vector<Value> values(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) assign(entry(arrival, list, i), values[i]);
  to = std::move(values);
}

void assign(const Arrival& arrival, std::array<double, 2>& to) {
  const List& list = entries_of(arrival);
  for (std::size_t i = 0; i < 2; ++i) assign(entry(arrival, list, i), to.at(i));
}

/// [diameter, percent]: the key's own number, and a plain one. Of a polygon both are lengths.
void assign_point(const Arrival& arrival, std::array<double, 2>& to) {
  const auto* pair = std::get_if<List>(&arrival.node.value);
  if (pair == nullptr || pair->size() != 2) arrival.want(wanted(arrival.key));
  assign(entry(arrival, *pair, 0), to[0]);
  if (arrival.key.path == "container.polygon") return assign(entry(arrival, *pair, 1), to[1]);
  Key percent{.path = arrival.key.path, .slot = {}, .range = {0.0, 100.0}};
  percent.slot = [&to](Input&) -> Slot { return &to[1]; };
  assign(Arrival{percent, (*pair)[1], arrival.in, arrival.path + "[1]"}, to[1]);
}

void assign(const Arrival& arrival, Curve& to) {
  const List& list = entries_of(arrival);
  Curve curve(list.size());
  for (std::size_t i = 0; i < list.size(); ++i) assign_point(entry(arrival, list, i), curve[i]);
  to = std::move(curve);
}

/// Where the entries of a Vec3 begin: a plane's spin is about z.
std::size_t first_axis(const Key& key, const Input& in) {
  return key.count == Count::spin_axes && in.container.dimension == 2 ? 2 : 0;
}

void assign(const Arrival& arrival, Vec3& to) {
  const List& list = entries_of(arrival);
  Vec3 values{};
  const std::size_t first = first_axis(arrival.key, arrival.in);
  for (std::size_t i = 0; i < list.size(); ++i) assign(entry(arrival, list, i), values.at(first + i));
  to = values;
}

std::string text_of(double value) { return number(value); }
std::string text_of(bool value) { return value ? "true" : "false"; }
std::string text_of(const std::optional<double>& value) { return value ? number(*value) : "\"auto\""; }
std::string text_of(const std::string& value) { return toml_string(value); }
template <std::integral Whole>
std::string text_of(Whole value) {
  return std::to_string(value);
}
template <class Enum>
requires std::is_enum_v<Enum> std::string text_of(Enum value) { return toml_string(word(value)); }

std::string text_of(const std::array<double, 2>& pair) {
  return fmt::format("[{}, {}]", number(pair[0]), number(pair[1]));
}

template <class Value>
std::string list_of(const Value* values, std::size_t count) {
  std::string text = "[";
  for (std::size_t i = 0; i < count; ++i) text += (i > 0 ? ", " : "") + text_of(values[i]);
  return text + "]";
}

}  // namespace

void store(const Key& key, const Node& node, Input& in) {
  const Arrival arrival{key, node, in, std::string(key.path)};
  std::visit([&](auto* target) { assign(arrival, *target); }, key.slot(in));
}

void store_default(const Key& key, Input& in) {
  const std::string_view standard = key.standard.value();
  std::string text(standard);
  if (standard.starts_with('=')) text = written(*find_key(standard.substr(1)), in);
  const Node value = parse_value(text, "default");
  if (std::holds_alternative<List>(value.value) || key.count == Count::one) return store(key, value, in);
  store(key, Node{"default", List(entries(key, in), value)}, in);
}

std::string written(const Key& key, Input& in) {
  const std::size_t count = entries(key, in);
  return std::visit(
      [&](const auto* value) -> std::string {
        using Value = std::remove_cvref_t<decltype(*value)>;
        if constexpr (std::is_same_v<Value, Vec3>) {
          return list_of(value->data() + first_axis(key, in), count);
        } else if constexpr (requires { value->data(); } && !std::is_same_v<Value, std::string>) {
          return list_of(value->data(), value->size());
        } else {
          return text_of(*value);
        }
      },
      key.slot(in));
}

}  // namespace packmpi::input
