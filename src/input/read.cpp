#include "input/read.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "base/error.hpp"
#include "base/text.hpp"
#include "checks/checks.hpp"
#include "config/mesh_vessel.hpp"
#include "config/restitution.hpp"
#include "config/vessel.hpp"
#include "document/document.hpp"
#include "input/fidelity.hpp"
#include "input/grading.hpp"
#include "input/keys.hpp"
#include "input/mixture.hpp"
#include "input/obstacle_tables.hpp"
#include "input/values.hpp"
#include "tables/known_names.hpp"

namespace packmpi::input {

using document::describe;
using document::Entry;
using document::fail;
using document::is_override;
using document::List;
using document::Node;
using document::parse_value;
using document::Table;
using tables::toml_string;

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

// Arrays of tables, which are read by input/mixture.cpp and input/obstacle_tables.cpp.
std::vector<std::string> with_arrays(std::vector<std::string> names, const std::string& table) {
  if (table.empty()) names.insert(names.end(), {"component", "pair", "stratum", "obstacle"});
  return names;
}

std::string in_words(const std::vector<std::string>& names) {
  return joined(std::vector<std::string_view>(names.begin(), names.end()), "and");
}

/// What the user may have meant by the unknown `name` in `table`.
std::string suggestion(const std::string& table, const std::string& name) {
  const std::vector<std::string> siblings = with_arrays(names_in(table), table);
  if (auto known = tables::known_elsewhere(table, name)) return *known;
  if (const auto near = text::closest(name, siblings)) return fmt::format("did you mean \"{}\"?", *near);
  for (const Key& key : keys()) {
    const auto [home, last] = split_path(key.path);
    if (last == name)
      return home.empty() ? fmt::format("\"{}\" belongs above all tables", name)
                          : fmt::format("\"{}\" belongs into [{}]", name, home);
  }
  const std::string where = table.empty() ? "a scene has" : fmt::format("[{}] has", table);
  return fmt::format("{} {}", where, in_words(siblings));
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
           fmt::format("is {}; give a table with {}", describe(entry.node), in_words(names_in(here))));
    }
    refuse_unknown(*inner, here);
  }
}

/// Why a key that does not apply is refused: the scene says otherwise, or a preset that it names does.
std::string misplaced(const Key& key, const Document& document, const Input& in) {
  const bool by_preset = key.when.words.starts_with("tangential") && document.find("contact.tangential") == nullptr &&
                         preset_law(document, "contact.tangential", in).has_value();
  if (!by_preset) return fmt::format("belongs to {} only; remove it", key.when.words);
  return fmt::format("belongs to {0} only, and fidelity = \"{1}\" has another; give contact.{0}, too, or remove it",
                     key.when.words, in.fidelity);
}

void read_key(const Key& key, const Document& document, Input& in) {
  const Node* node = document.find(key.path);
  if (!key.applies(in)) {
    if (node != nullptr) fail(node->place, key.path, misplaced(key, document, in));
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

/// A scene may give diameters, [particles.diameter], in place of radii.
constexpr std::string_view radius_table = "particles.radius", diameter_table = "particles.diameter";

/// Diameters under the names of radii; the values are halved when they are stored. False: the scene gives radii.
bool rename_diameters(Document& document) {
  const Node* diameter = document.find(diameter_table);
  if (diameter == nullptr) return false;
  if (document.find(radius_table) != nullptr) {
    fail(diameter->place, diameter_table, "there is particles.radius, too; remove one of them");
  }
  if (const Node* radii = document.find("particles.diameter.radii")) {
    fail(radii->place, "particles.diameter.radii", "is here called diameters; rename it");
  }
  document.rename("particles.diameter.diameters", "radii");
  return document.rename(diameter_table, "radius");
}

/// Of a cylinder, size = [D, D, H_d] stands for its diameter and height. What the command line sets replaces what the
/// file says of the same lengths.
void take_size_of_cylinder(Document& document) {
  const Node* shape = document.find("container.shape");
  const Node* size = document.find("container.size");
  if (shape == nullptr || size == nullptr || describe(*shape) != "\"cylinder\"") return;
  const auto* list = std::get_if<List>(&size->value);
  if (list == nullptr || list->size() != 3 || describe((*list)[0]) != describe((*list)[1])) {
    fail(size->place, "container.size",
         fmt::format("is {}; a cylinder has a diameter and a height: give those, or size = [D, D, H] with the diameter "
                     "twice",
                     list == nullptr || list->size() != 3
                         ? describe(*size)
                         : fmt::format("{} by {}", describe((*list)[0]), describe((*list)[1]))));
  }
  const List lengths = *list;
  const bool wins = is_override(*size);
  const std::string place = size->place;
  for (const auto& [path, k] : {std::pair("container.diameter", 0), std::pair("container.height", 2)}) {
    const Node* own = document.find(path);
    if (own != nullptr && !wins && !is_override(*own)) {
      fail(place, "container.size", fmt::format("there is a {}, too; remove one of them", path));
    }
    if (own == nullptr || wins) document.put(path, lengths[static_cast<std::size_t>(k)]);
  }
  document.erase("container.size");
}

/// Nothing has room far above H_d where the walls close in: layers end there.
void take_region(const Document& document, Input& in) {
  if (!container_of(in.container).closes() || insertion_alone(in) || in.layers.region == RegionRule::container) return;
  if (document.find("layers.region") != nullptr) {
    fail(document.place("layers.region"), "layers.region",
         "this vessel narrows towards its top, where layers above H_d have no room; give \"container\", or leave it "
         "out");
  }
  in.layers.region = RegionRule::container;
}

/// What is said of radii, in the names of the scene.
std::string in_diameters(std::string words) {
  for (const auto& [ours, theirs] :
       {std::pair(std::string("particles.radius.radii"), std::string("particles.diameter.diameters")),
        std::pair(std::string(radius_table), std::string(diameter_table))}) {
    for (std::size_t at = words.find(ours); at != std::string::npos; at = words.find(ours, at + theirs.size())) {
      words.replace(at, ours.size(), theirs);
    }
  }
  return words;
}

Document with_changes(const std::string& text, const std::string& path, const Overrides& overrides) {
  Document document(text, path);
  for (const std::string& assignment : overrides.set) document.set(assignment);
  return document;
}

/// Puts the CSV file's points where the scene's own would stand, the finest first.
void take_curve(const Document& document, const std::optional<CurveFile>& file, Input& in) {
  Radius& radius = in.particles.radius;
  std::ranges::stable_sort(radius.diameter_curve, {}, [](const auto& point) { return point[0]; });
  if (radius.diameter_curve_file.empty()) return;
  check_name(document.place(curve_file_key), curve_file_key, radius.diameter_curve_file, "curve");
  if (!radius.diameter_curve.empty()) {
    fail(document.place(curve_file_key), curve_file_key, "there is a diameter_curve, too; remove one of them");
  }
  if (!file) fail(document.place(curve_file_key), curve_file_key, "no file comes with this text; give diameter_curve");
  tables::SieveTable table = tables::read_sieve_table(*file);
  radius.diameter_curve = std::move(table.curve);
  in.remarks.push_back(std::move(table.reading));
  if (const std::string words = flaw(radius.diameter_curve, radius.keep_percent); !words.empty()) {
    throw Error(ExitCode::bad_input, fmt::format("{}: the curve {}", file->path, words));
  }
  radius.diameter_curve_file.clear();
}

/// Puts the CSV file's radii where the scene's own would stand. The list is the number of particles.
void take_list(const Document& document, const std::optional<CurveFile>& file, Input& in) {
  Radius& radius = in.particles.radius;
  if (radius.distribution != SizeDistribution::list) return;
  if (!radius.list_file.empty()) {
    check_name(document.place(list_file_key), list_file_key, radius.list_file, "list");
    if (!radius.radii.empty()) {
      fail(document.place(list_file_key), list_file_key, "there are radii, too; remove one of them");
    }
    if (!file) fail(document.place(list_file_key), list_file_key, "no file comes with this text; give radii");
    tables::SizeList list = tables::read_size_list(*file);
    radius.radii = std::move(list.radii);
    in.remarks.push_back(std::move(list.reading));
    radius.list_file.clear();
  }
  const auto sizes = std::ssize(radius.radii);
  if (in.particles.count != 0 && in.particles.count != sizes) {
    fail(document.place("particles.count"), "particles.count",
         fmt::format("is {}, and the list has {} sizes, each for one particle; remove it", in.particles.count, sizes));
  }
  in.particles.count = sizes;
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

void read_document(const Document& document, const NamedFiles& files, const MixtureTables& mixture, Input& in) {
  refuse_unknown(document.root(), "");
  if (document.find("near_field") != nullptr) in.near_field.emplace();
  if (document.find("start") != nullptr) in.start.emplace();
  if (document.find("target") != nullptr) in.target.emplace();
  if (document.find("confinement") != nullptr) in.confinement.emplace();
  if (mixture.components.size() > 1) in.components.resize(mixture.components.size());  // the condition of [mixture]
  for (const Key& key : keys()) {
    if (key.path == "container.size") check_shape(in, document);
    read_key(key, document, in);
  }
  if (!in.container.file.empty()) check_name(document.place(mesh_file_key), mesh_file_key, in.container.file, "mesh");
  take_mesh(document, files.surfaces, in);
  take_vessel(document, in.container);
  if (insertion_alone(in)) in.layers.thickness = in.container.size.back();
  take_curve(document, files.curve, in);
  take_list(document, files.curve, in);
  take_restitution(document, in.contact);
  try {
    if (in.components.empty()) check_radii(in, document);
    take_mixture(mixture, document, in);
    apply_preset(document, in);
    take_region(document, in);
    check(in, document);
  } catch (const Error& error) {
    const std::string words = error.what();
    if (!in.particles.radius.diameters || words.find(radius_table) == std::string::npos) throw;
    throw Error(error.code(), words + " (its lengths are radii)");
  }
}

}  // namespace

std::string effective_of(Input in) {
  std::string text, open;
  for (const Key& key : keys()) {
    if (!key.applies(in) || (!in.components.empty() && is_of_component(key.path))) continue;
    const auto [table, name] = split_path(key.path);
    if (table != open) text += fmt::format("\n[{}]\n", table);
    open = table;
    text += fmt::format("{} = {}\n", name, written(key, in));
  }
  return text + effective_mixture(in);
}

NamedFiles named_files(const std::string& text, const std::string& path, const Overrides& overrides) {
  Document document = with_changes(text, path, overrides);
  rename_diameters(document);
  const std::vector<Obstacle> obstacles = take_obstacle_tables(document);
  return read_named(document, obstacles, path);
}

Input parse(const std::string& text, const std::string& path, const Overrides& overrides, const NamedFiles& files) {
  Document document = with_changes(text, path, overrides);
  const MixtureTables mixture = split_mixture(document);
  Input in;
  in.file = path;
  in.name = std::filesystem::path(path).stem().string();
  in.obstacles = take_obstacle_tables(document);
  in.particles.radius.diameters = rename_diameters(document);
  take_size_of_cylinder(document);
  try {
    read_document(document, files, mixture, in);
  } catch (const Error& error) {
    if (!in.particles.radius.diameters) throw;
    throw Error(error.code(), in_diameters(error.what()));
  }
  in.particles.radius.diameters = false;
  in.effective = effective_of(in);
  return in;
}

Input parse_part(Document document, const std::string& path) {
  Input in;
  in.file = path;
  in.particles.radius.diameters = rename_diameters(document);
  read_document(document, {}, {}, in);
  return in;
}

Input read(const comm::Comm& comm, const std::string& path, const Overrides& overrides) {
  std::string text;
  NamedFiles files;
  comm::agree_on(comm, [&] {
    if (comm.rank() != 0) return;
    text = file_text(path, "a scene file (.toml)", Document::longest_file);
    files = named_files(text, path, overrides);
  });
  text = comm.broadcast(0, text);
  files = broadcast(comm, files);
  Input in;
  comm::agree_on(comm, [&] { in = parse(text, path, overrides, files); });
  return in;
}

}  // namespace packmpi::input
