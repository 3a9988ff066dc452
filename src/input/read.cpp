#include "input/read.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "base/error.hpp"
#include "base/regular_file.hpp"
#include "base/text.hpp"
#include "input/checks.hpp"
#include "input/document.hpp"
#include "input/fidelity.hpp"
#include "input/keys.hpp"
#include "input/restitution.hpp"
#include "input/values.hpp"

namespace packmpi::input {
namespace {

/// The names that may stand directly in `table`: keys and tables, in the key table's order.
std::vector<std::string> names_in(std::string_view table) {
  const std::string prefix = table.empty() ? "" : std::string(table) + ".";
  std::vector<std::string> names;
  for (const Key& key : keys()) {
    if (!key.path.starts_with(prefix)) continue;
    const std::string_view rest = key.path.substr(prefix.size());
    const std::string name(rest.substr(0, rest.find('.')));
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

std::string list(const std::vector<std::string>& names) {
  return joined(std::vector<std::string_view>(names.begin(), names.end()), "and");
}

/// What the user may have meant by the unknown `name` in `table`.
std::string suggestion(const std::string& table, const std::string& name) {
  const std::vector<std::string> siblings = names_in(table);
  if (const auto near = text::closest(name, siblings)) return fmt::format("did you mean \"{}\"?", *near);
  for (const Key& key : keys()) {
    const auto [home, last] = split_path(key.path);
    if (last == name)
      return home.empty() ? fmt::format("\"{}\" belongs above all tables", name)
                          : fmt::format("\"{}\" belongs into [{}]", name, home);
  }
  const std::string where = table.empty() ? "a scene has" : fmt::format("[{}] has", table);
  return fmt::format("{} {}", where, list(siblings));
}

/// A name as it would be written in TOML; control characters escaped, so that it stays on one line.
std::string name_text(const std::string& name) {
  const bool bare = !name.empty() && std::ranges::all_of(name, [](unsigned char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '-';
  });
  return bare ? name : toml_string(name);
}

/// A key that has another name now; told for one version.
struct Renamed {
  std::string_view path, now;
};
constexpr std::array renamed_keys = {Renamed{"dynamics.thaw", "dynamics.relaxation"}};

void refuse_renamed(const Entry& entry, const std::string& path) {
  const auto* key = std::ranges::find(renamed_keys, path, &Renamed::path);
  if (key != renamed_keys.end()) fail(entry.node.place, path, fmt::format("is now {}", key->now));
}

/// A key that there was once. Written with its only value left it means nothing and is passed over.
struct Removed {
  std::string_view path, left, words;
};
constexpr std::array removed_keys = {Removed{
    "dynamics.precision", "double",
    "mixed precision was removed, since it gained nothing in whole jobs; use \"double\", or leave the key out"}};

/// Was `path` a key that is passed over? Refuses it, by name, with another value than the one left.
bool is_removed(const Entry& entry, const std::string& path) {
  const auto* key = std::ranges::find(removed_keys, path, &Removed::path);
  if (key == removed_keys.end()) return false;
  const auto* text = std::get_if<std::string>(&entry.node.value);
  if (text == nullptr || *text != key->left) fail(entry.node.place, path, std::string(key->words));
  return true;
}

void refuse_unknown(const Table& table, const std::string& path) {
  const std::vector<std::string> known = names_in(path);
  for (const Entry& entry : table) {
    const std::string here = (path.empty() ? "" : path + ".") + name_text(entry.name);
    if (is_removed(entry, here)) continue;
    refuse_renamed(entry, here);
    if (std::ranges::find(known, entry.name) == known.end()) {
      fail(entry.node.place, here, "unknown key; " + suggestion(path, entry.name));
    }
    if (find_key(here) != nullptr) continue;
    const auto* inner = std::get_if<Table>(&entry.node.value);
    if (inner == nullptr) {
      fail(entry.node.place, here,
           fmt::format("is {}; give a table with {}", describe(entry.node), list(names_in(here))));
    }
    refuse_unknown(*inner, here);
  }
}

void read_key(const Key& key, const Document& document, Input& in) {
  const Node* node = document.find(key.path);
  if (!key.applies(in)) {
    if (node != nullptr) fail(node->place, key.path, fmt::format("belongs to {} only; remove it", key.when.words));
  } else if (node != nullptr) {
    store(key, *node, in);
  } else if (const auto law = preset_law(document, key.path, in)) {
    store(key, parse_value(std::string(*law), "preset"), in);
  } else if (key.standard) {
    store_default(key, in);
  } else {
    const std::size_t count = entries(key, in);
    const std::string list = count == 0 ? "a list" : fmt::format("a list of {}", count);
    const bool is_list = key.count != Count::one;
    fail(document.place(key.path), key.path,
         is_list ? fmt::format("is missing; give {}, each {}", list, wanted(key))
                 : fmt::format("is missing; give {}", wanted(key)));
  }
}

/// The scene with every default filled in. Reading it back gives the same scene and the same text.
std::string effective(Input in) {
  std::string text, open;
  for (const Key& key : keys()) {
    if (!key.applies(in)) continue;
    const auto [table, name] = split_path(key.path);
    if (table != open) text += fmt::format("\n[{}]\n", table);
    open = table;
    text += fmt::format("{} = {}\n", name, written(key, in));
  }
  return text;
}

std::string file_text(const std::string& path, std::string_view what) {
  const auto refuse = [&](const std::string& words) { throw Error(ExitCode::bad_input, path + ": " + words); };
  const RegularFile file(path);
  const std::string& flaw = file.flaw();
  if (!flaw.empty()) refuse(flaw + (flaw.starts_with("cannot") ? "; check the path" : fmt::format("; give {}", what)));
  const std::optional<std::string> text = file.read(0, Document::longest_file + 1);
  if (!text) refuse("cannot be read to its end; check the file system");
  if (text->size() > Document::longest_file) refuse(fmt::format("is longer than 1 MiB; is it {}?", what));
  return *text;
}

Document with_changes(const std::string& text, const std::string& path, const Overrides& overrides) {
  Document document(text, path);
  for (const std::string& assignment : overrides.set) document.set(assignment);
  return document;
}

constexpr std::string_view curve_file_key = "particles.radius.diameter_curve_file";

// A scene may be a stranger's: it names files beside it only.
void check_curve_name(const Document& document, const std::string& name) {
  const std::filesystem::path path(name);
  const bool leaves = path.is_absolute() || std::ranges::find(path, "..") != path.end();
  if (!leaves) return;
  fail(document.place(curve_file_key), curve_file_key,
       fmt::format("is {}; a curve lies in the scene's folder or below it: give a path from there, without \"..\"",
                   toml_string(name)));
}

/// Puts the CSV file's points where the scene's own would stand.
void take_curve(const Document& document, const std::optional<CurveFile>& file, Radius& radius) {
  if (radius.diameter_curve_file.empty()) return;
  check_curve_name(document, radius.diameter_curve_file);
  if (!radius.diameter_curve.empty()) {
    fail(document.place(curve_file_key), curve_file_key, "there is a diameter_curve, too; remove one of them");
  }
  if (!file) fail(document.place(curve_file_key), curve_file_key, "no file comes with this text; give diameter_curve");
  radius.diameter_curve = read_curve(*file);
  if (const std::string words = flaw(radius.diameter_curve); !words.empty()) {
    throw Error(ExitCode::bad_input, fmt::format("{}: the curve {}", file->path, words));
  }
  radius.diameter_curve_file.clear();
}

/// The damping ratio that a restitution stands for. A scene that was written with every default filled in has both.
void take_restitution(const Document& document, Contact& contact) {
  if (!contact.restitution) return;
  const double damping = damping_of(*contact.restitution, contact.tension_cutoff);
  if (document.find("contact.damping_ratio") != nullptr && contact.damping_ratio != damping) {
    fail(document.place("contact.restitution"), "contact.restitution",
         fmt::format("there is a damping_ratio of {:g}, too, of which it would be {:.4g}; remove one of them",
                     contact.damping_ratio, restitution_of(contact.damping_ratio, contact.tension_cutoff)));
  }
  contact.damping_ratio = damping;
}

}  // namespace

std::optional<CurveFile> named_curve(const std::string& text, const std::string& path, const Overrides& overrides) {
  const Document document = with_changes(text, path, overrides);
  const Node* node = document.find(curve_file_key);
  const auto* name = node == nullptr ? nullptr : std::get_if<std::string>(&node->value);
  const bool both = document.find("particles.radius.diameter_curve") != nullptr;  // parse() refuses that
  if (name == nullptr || name->empty() || both) return std::nullopt;
  check_curve_name(document, *name);
  const std::string file = (std::filesystem::path(path).parent_path() / *name).string();
  return CurveFile{file, file_text(file, "a CSV file")};
}

Input parse(const std::string& text, const std::string& path, const Overrides& overrides,
            const std::optional<CurveFile>& curve) {
  const Document document = with_changes(text, path, overrides);
  refuse_unknown(document.root(), "");
  Input in;
  in.file = path;
  in.name = std::filesystem::path(path).stem().string();
  if (document.find("near_field") != nullptr) in.near_field.emplace();
  for (const Key& key : keys()) read_key(key, document, in);
  take_curve(document, curve, in.particles.radius);
  take_restitution(document, in.contact);
  check_radii(in, document);
  apply_preset(document, in);
  check(in, document);
  in.effective = effective(in);
  return in;
}

Input read(const comm::Comm& comm, const std::string& path, const Overrides& overrides) {
  std::string text;
  CurveFile curve;
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0) return;
    text = file_text(path, "a scene file (.toml)");
    curve = named_curve(text, path, overrides).value_or(CurveFile{});
  });
  text = comm.broadcast(0, text);
  curve = {comm.broadcast(0, curve.path), comm.broadcast(0, curve.text)};
  Input in;
  comm::agree_on(comm,
                 [&] { in = parse(text, path, overrides, curve.path.empty() ? std::nullopt : std::optional(curve)); });
  return in;
}

}  // namespace packmpi::input
