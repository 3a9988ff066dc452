/// The input reader with any text at all: it is refused in the right words, or it is taken as it stands. The bytes are
/// a scene; after a line "%%" the grading curve that it names; after further ones assignments, as of --set.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "document/document.hpp"
#include "fuzz/demand.hpp"
#include "input/keys.hpp"
#include "input/read.hpp"
#include "scene/scene.hpp"

namespace packmpi::fuzz {
namespace {

const std::string scene_name = "scene.toml", curve_name = "curve.csv", effective_name = "effective.toml";

struct Case {
  std::string scene;
  input::NamedFiles files;
  input::Overrides overrides;
};

Case case_of(const std::string& text) {
  const std::string mark = "\n%%\n";
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(mark, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + mark.size();
  }
  if (parts.empty()) parts.emplace_back();
  Case scene{parts[0], {}, {}};
  if (parts.size() > 1 && !parts[1].empty()) scene.files.curve = input::CurveFile{curve_name, parts[1]};
  for (std::size_t k = 2; k < parts.size(); ++k) scene.overrides.set.push_back(parts[k]);
  return scene;
}

/// One line, which begins with the place, for exit code 2.
void check_refusal(const Error& error) {
  const std::string words = error.what();
  demand(error.code() == ExitCode::bad_input, "refused with another code than bad_input: " + words);
  demand(std::ranges::none_of(words, [](unsigned char c) { return c < 0x20 || c == 0x7f; }), "not one line: " + words);
  const auto begins = [&](const std::string& place) { return words.starts_with(place); };
  demand(begins(scene_name + ":") || begins(curve_name + ":") || begins("--set "), "no place: " + words);
}

template <class Action>
bool accepted(Action&& action) {
  try {
    action();
    return true;
  } catch (const Error& error) {
    check_refusal(error);
    return false;
  }
}

double real(const document::Node& node) {
  const auto* whole = std::get_if<std::int64_t>(&node.value);
  return whole != nullptr ? static_cast<double>(*whole) : std::get<double>(node.value);
}

bool is_number(const document::Node& node) {
  return std::holds_alternative<std::int64_t>(node.value) || std::holds_alternative<double>(node.value);
}

/// Whether the value of the effective input is the one asked for. A number with a unit is left to the unit's tests.
bool same(const document::Node& asked, const document::Node& got) {
  if (is_number(asked)) return is_number(got) && real(asked) == real(got);
  if (const auto* list = std::get_if<document::List>(&asked.value)) {
    const auto* other = std::get_if<document::List>(&got.value);
    return other != nullptr && std::ranges::equal(*list, *other, same);
  }
  if (std::holds_alternative<std::string>(asked.value) && is_number(got)) return true;
  if (const auto* text = std::get_if<std::string>(&asked.value)) return *text == std::get<std::string>(got.value);
  return std::get<bool>(asked.value) == std::get<bool>(got.value);
}

/// Files, whose contents stand there instead; prisms, which are meshes; points, the finest first; the number of a list,
/// which may be 0.
bool is_rewritten(const std::string& key) {
  return key == "particles.radius.diameter_curve_file" || key == "particles.radius.list_file" ||
         key == "container.file" || key == "container.unit" || key == "container.surface" || key == "container.shape" ||
         key == "container.polygon" || key == "particles.radius.diameter_curve" || key == "particles.count";
}

const document::Node* entry_of(const document::Table& table, const std::string& name) {
  const auto found = std::ranges::find(table, name, &document::Entry::name);
  return found == table.end() ? nullptr : &found->node;
}

/// Every value of a component, a pair or a stratum is in the table that stands for it.
void check_tables(const document::Table& asked, const document::Table& got, const std::string& path) {
  for (const document::Entry& entry : asked) {
    const std::string here = path + "." + entry.name;
    const std::string key = "particles" + here.substr(here.find('.'));
    if (entry.name == "diameter" || entry.name == "restitution" || is_rewritten(key)) continue;  // under other names
    const document::Node* node = entry_of(got, entry.name);
    demand(node != nullptr, "is passed over: " + here);
    if (const auto* inner = std::get_if<document::Table>(&entry.node.value)) {
      check_tables(*inner, std::get<document::Table>(node->value), here);
    } else {
      demand(same(entry.node, *node), "is not what was asked for: " + here);
    }
  }
}

/// The tables of a mixture, in their order. Of several components [particles] is what those have that say nothing else.
bool is_of_mixture(const document::Table& root, const document::Document& effective, const document::Entry& entry) {
  const document::Node* components = effective.find("component");
  if (components == nullptr) return entry_of(root, "component") != nullptr && entry.name != "container";
  if (entry.name == "particles") return true;
  if (entry.name != "component" && entry.name != "pair" && entry.name != "stratum") return false;
  const document::Node* got = effective.find(entry.name);
  const auto& asked = std::get<document::List>(entry.node.value);
  demand(got != nullptr && std::get<document::List>(got->value).size() == asked.size(), "other tables: " + entry.name);
  for (std::size_t k = 0; k < asked.size(); ++k) {
    check_tables(std::get<document::Table>(asked[k].value),
                 std::get<document::Table>(std::get<document::List>(got->value)[k].value), entry.name);
  }
  return true;
}

/// With obstacles the container is a mesh that has them as holes.
bool is_of_obstacles(const document::Table& root, const document::Entry& entry) {
  return entry_of(root, "obstacle") != nullptr && (entry.name == "obstacle" || entry.name == "container");
}

/// Every value of the document is a key's, and the effective input has it.
void check_nothing_is_passed_over(const document::Table& table, const std::string& path,
                                  const document::Document& effective) {
  for (const document::Entry& entry : table) {
    if (path.empty() && is_of_mixture(table, effective, entry)) continue;
    if (path.empty() && is_of_obstacles(table, entry)) continue;
    const std::string here = (path.empty() ? "" : path + ".") + entry.name;
    if (here == "particles.diameter") continue;  // stands under radius, halved
    if (input::find_key(here) == nullptr) {
      const auto* inner = std::get_if<document::Table>(&entry.node.value);
      demand(inner != nullptr, "an unknown key is accepted: " + here);
      check_nothing_is_passed_over(*inner, here, effective);
    } else if (!is_rewritten(here)) {
      const document::Node* got = effective.find(here);
      demand(got != nullptr && same(entry.node, *got), "is not what was asked for: " + here);
    }
  }
}

void check_accepted(const Case& scene, const input::Input& in) {
  const input::Input again = input::parse(in.effective, effective_name, {});
  demand(again.effective == in.effective, "the effective input is read as another one");

  document::Document asked(scene.scene, scene_name);
  for (const std::string& assignment : scene.overrides.set) asked.set(assignment);
  check_nothing_is_passed_over(asked.root(), "", document::Document(in.effective, effective_name));

  Case more = scene;
  more.scene += "\nno_such_key = 1\n";
  demand(!accepted([&] { (void)input::parse(more.scene, scene_name, more.overrides, more.files); }),
         "an unknown key at the end is accepted");
}

void try_scene(const std::string& text) {
  const Case scene = case_of(text);
  input::Input in;
  if (!accepted([&] { in = input::parse(scene.scene, scene_name, scene.overrides, scene.files); })) return;
  check_accepted(scene, in);
  (void)accepted([&] { (void)scene::build(in); });
}

}  // namespace
}  // namespace packmpi::fuzz

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer's name
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  packmpi::fuzz::within_a_second([&] { packmpi::fuzz::try_scene(text); });
  return 0;
}
