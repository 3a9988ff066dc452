#include "input/mixture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.hpp"
#include "config/radius_range.hpp"
#include "config/restitution.hpp"
#include "config/strata.hpp"
#include "config/vessel.hpp"
#include "geometry/volume.hpp"
#include "input/array_tables.hpp"

namespace packmpi::input {

using document::describe;
using document::Entry;
using document::fail;
using document::List;
using document::Table;
using tables::toml_string;

namespace {

constexpr std::array<std::string_view, 5> of_particles{"density", "youngs_modulus", "poisson_ratio", "radius",
                                                       "diameter"};
constexpr std::array<std::string_view, 6> of_contact{"friction",    "wall_friction",    "damping_ratio",
                                                     "restitution", "rolling_friction", "twisting_friction"};

/// `base`'s entries, and those of the component that `names` has in their place.
Node merged(const Node* base, const Node& component, std::span<const std::string_view> names) {
  Node result{component.place, Table{}};
  Table& out = std::get<Table>(result.value);
  const auto has = [&](std::string_view name) { return entry(component, name) != nullptr; };
  const auto replaced = [&](std::string_view name) {
    const bool sizes = name == "radius" || name == "diameter";
    const bool damping = name == "restitution" || name == "damping_ratio";
    return has(name) || (sizes && (has("radius") || has("diameter"))) ||
           (damping && (has("restitution") || has("damping_ratio")));
  };
  if (base != nullptr && std::holds_alternative<Table>(base->value)) {
    std::ranges::copy_if(table_of(*base), std::back_inserter(out), [&](const Entry& e) { return !replaced(e.name); });
  }
  std::ranges::copy_if(table_of(component), std::back_inserter(out),
                       [&](const Entry& e) { return is_in(names, e.name); });
  return result;
}

/// A name for tables and files of other codes.
std::string name_at(std::string_view path, const Node& node) {
  const auto* name = std::get_if<std::string>(&node.value);
  const bool plain =
      name != nullptr && !name->empty() && name->size() <= 32 &&
      std::ranges::all_of(*name, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
  if (!plain) fail(node.place, path, fmt::format("is {}; give a word of letters, digits, _ and -", describe(node)));
  return *name;
}

int component_named(const Input& in, std::string_view path, const Node& node) {
  const auto* name = std::get_if<std::string>(&node.value);
  const auto found = std::ranges::find(in.components, name != nullptr ? *name : "", &Component::name);
  if (found != in.components.end()) return static_cast<int>(found - in.components.begin());
  std::string names;
  for (const Component& of : in.components) names += fmt::format("{}\"{}\"", names.empty() ? "" : ", ", of.name);
  fail(node.place, path, fmt::format("is {}, which is no component; there are {}", describe(node), names));
}

/// The component as the only one of a scene.
Input scene_of(const Node& table, const Node* particles, const Document& document, const std::string& name,
               const Input& in) {
  Document part = document;
  if (part.find("container.file") != nullptr) {  // which has been read
    part.erase("container.file");
    part.put("container.surface", {table.place, in.container.surface});
    part.put("container.unit", {table.place, in.container.unit});
  }
  for (const char* other : {"mixture", "start", "target", "confinement", "ensemble", "near_field"})
    (void)part.take(other);
  part.put("particles", merged(particles, table, of_particles));
  part.put("contact", merged(document.find("contact"), table, of_contact));
  try {
    return parse_part(std::move(part), in.file);
  } catch (const Error& error) {
    std::string words = error.what();
    for (std::size_t at = words.find("particles."); at != std::string::npos; at = words.find("particles.", at)) {
      words.replace(at, 10, "component.");
    }
    throw Error(error.code(), fmt::format("{} (of component {})", words, toml_string(name)));
  }
}

/// Its name and share, which one component has as several do.
Component named(const Node& table) {
  const Node* name = entry(table, "name");
  if (name == nullptr) fail(table.place, "component.name", "is missing; give a word by which the component is known");
  Component one;
  one.name = name_at("component.name", *name);
  if (const Node* share = entry(table, "share"))
    one.share = number_at("component.share", *share, tables::ratio, from_zero);
  return one;
}

Component component_of(const Node& table, const Node* particles, const Document& document, const Input& in) {
  Component one = named(table);
  if (std::ranges::find(in.components, one.name, &Component::name) != in.components.end())
    fail(entry(table, "name")->place, "component.name",
         fmt::format("there is a component \"{}\" already; give another name", one.name));
  const Input part = scene_of(table, particles, document, one.name, in);
  if (part.particles.radius.distribution == SizeDistribution::list)
    fail(table.place, "component.radius.distribution",
         "\"list\" gives sizes one by one, not of a share; use \"discrete\"");
  one.particles = part.particles;
  one.friction = part.contact.friction;
  one.wall_friction = part.contact.wall_friction;
  one.damping_ratio = part.contact.damping_ratio;
  one.rolling_friction = part.contact.rolling_friction;
  one.twisting_friction = part.contact.twisting_friction;
  return one;
}

ComponentPair pair_of(const Node& table, const Input& in) {
  constexpr std::array<std::string_view, 6> known{"components",  "friction",         "damping_ratio",
                                                  "restitution", "rolling_friction", "twisting_friction"};
  refuse_unknown_in(table, "pair", known);
  const Node* names = entry(table, "components");
  const auto* list = names == nullptr ? nullptr : std::get_if<List>(&names->value);
  if (list == nullptr || list->size() != 2)
    fail(names == nullptr ? table.place : names->place, "pair.components", "give a list of two names of components");
  ComponentPair pair{.first = component_named(in, "pair.components", (*list)[0]),
                     .second = component_named(in, "pair.components", (*list)[1])};
  for (const ComponentPair& other : in.pairs) {
    if (std::minmax(other.first, other.second) == std::minmax(pair.first, pair.second))
      fail(table.place, "pair.components", "there is a [[pair]] of these two already; remove one of them");
  }
  const auto read = [&](std::string_view path, std::string_view key, Range range, std::optional<double>& value) {
    if (const Node* node = entry(table, key)) value = number_at(path, *node, plain, range);
  };
  std::optional<double> restitution;
  read("pair.friction", "friction", from_zero, pair.friction);
  read("pair.damping_ratio", "damping_ratio", from_zero, pair.damping_ratio);
  read("pair.restitution", "restitution", {0.0, 1.0, true, false}, restitution);
  read("pair.rolling_friction", "rolling_friction", from_zero, pair.rolling_friction);
  read("pair.twisting_friction", "twisting_friction", from_zero, pair.twisting_friction);
  if (restitution && pair.damping_ratio)
    fail(table.place, "pair.restitution", "there is a damping_ratio, too; remove one of them");
  if (restitution) pair.damping_ratio = damping_of(*restitution, in.contact.tension_cutoff);
  const bool rolls = pair.rolling_friction.value_or(0.0) > 0.0 || pair.twisting_friction.value_or(0.0) > 0.0;
  if (rolls && in.contact.tangential != Tangential::mindlin)
    fail(table.place, "pair.rolling_friction", "belongs to tangential = \"mindlin\" only; remove it");
  return pair;
}

/// {gravel = 0.7, sand = 0.3}: of each component, 0 of those that are not named.
std::vector<double> shares_of(const Node& node, const Input& in) {
  const auto* table = std::get_if<Table>(&node.value);
  if (table == nullptr)
    fail(node.place, "stratum.shares", fmt::format("is {}; give {{name = share, ...}}", describe(node)));
  std::vector<double> shares(in.components.size(), 0.0);
  double sum = 0.0;
  for (const Entry& item : *table) {
    const int k = component_named(in, "stratum.shares", {item.node.place, item.name});
    sum += shares[static_cast<std::size_t>(k)] = number_at("stratum.shares", item.node, tables::ratio, from_zero);
  }
  if (!(sum > 0.0)) fail(node.place, "stratum.shares", "add up to 0; give a share above 0");
  return shares;
}

Stratum stratum_of(const Node& table, const Input& in) {
  constexpr std::array<std::string_view, 4> known{"name", "top", "mass", "shares"};
  refuse_unknown_in(table, "stratum", known);
  Stratum one;
  const Node* name = entry(table, "name");
  one.name = name != nullptr ? name_at("stratum.name", *name) : fmt::format("{}", in.strata.size() + 1);
  const Node *top = entry(table, "top"), *mass = entry(table, "mass"), *shares = entry(table, "shares");
  if (top != nullptr) one.top = number_at("stratum.top", *top, length, above_zero);
  if (mass != nullptr) one.mass = number_at("stratum.mass", *mass, tables::mass, above_zero);
  if (top != nullptr && mass != nullptr)
    fail(table.place, "stratum.mass",
         "there is a top, too: a stratum ends at a height or with a mass; remove one of them");
  if (shares != nullptr) one.shares = shares_of(*shares, in);
  return one;
}

void check_strata(const MixtureTables& tables, const Input& in) {
  if (in.strata.empty()) return;
  const bool masses = in.strata.front().mass.has_value();
  double below = 0.0;
  for (std::size_t k = 0; k < in.strata.size(); ++k) {
    const Stratum& one = in.strata[k];
    const std::string& place = tables.strata[k].place;
    const bool last = k + 1 == in.strata.size();
    if (one.mass.has_value() != masses && !(last && !masses && !one.mass))
      fail(place, "stratum.mass", "either all strata end with a mass or none does; give top or mass to all alike");
    if (!masses && !last && !one.top)
      fail(place, "stratum.top", "is missing; give the height [m] where the stratum ends");
    if (!one.top) continue;
    const std::string& top = entry(tables.strata[k], "top")->place;
    if (!(*one.top > below))
      fail(top, "stratum.top",
           fmt::format("{:g} m is not above {:g} m, where it begins; strata go from below", *one.top, below));
    const double height = in.container.size.back();
    if (*one.top > height || (last && *one.top < height))
      fail(top, "stratum.top",
           fmt::format("{:g} m is {} H_d = {:g} m, the end of the last stratum; change one of them", *one.top,
                       *one.top > height ? "above" : "below", height));
    below = *one.top;
  }
}

/// A stratum that ends with a mass has room for a particle.
void check_masses(const MixtureTables& tables, const Input& in) {
  for (std::size_t k = 0; k < in.strata.size(); ++k) {
    const Stratum& one = in.strata[k];
    if (!one.mass) continue;
    double lightest = HUGE_VAL;
    for (std::size_t c = 0; c < in.components.size(); ++c) {
      const Component& of = in.components[c];
      if (!(share_in(in, one, c) > 0.0)) continue;
      const double r = radius_range(of.particles.radius).smallest;
      lightest = std::min(lightest, of.particles.density * geometry::volume(in.container.dimension, r));
    }
    if (*one.mass < lightest) {
      fail(entry(tables.strata[k], "mass")->place, "stratum.mass",
           fmt::format("{:g} kg is less than the lightest particle of this stratum, {:.3g} kg; give more", *one.mass,
                       lightest));
    }
  }
}

/// What does not go together with several components, by name.
void check_mixture(const MixtureTables& tables, const Document& document, const Input& in) {
  const auto refuse = [&](std::string_view path, std::string_view words) { fail(document.place(path), path, words); };
  if (in.particles.count > 0)
    refuse("particles.count", "several components are counted by their shares, not by one number; remove it");
  if (in.start && !in.strata.empty())
    fail(tables.strata.front().place, "stratum",
         "strata are laid from the floor; with [start], give the components the shares of what comes on top, or remove "
         "one of them");
  if (in.target && !in.strata.empty())
    refuse("target", "is found on a sample of one recipe, and strata have several; remove one of them");
  if (in.dynamics.theta > 0.0) refuse("dynamics.theta", "implicit steps know one material only; use 0");
  if (in.layers.region == RegionRule::container && !container_of(in.container).closes())  // there it is no choice
    refuse("layers.region", "\"container\" thins out the last layers, which would spoil the shares; use \"open\"");
  if (insertion_alone(in) && !in.strata.empty())
    fail(tables.strata.front().place, "stratum",
         "strata are laid by layers that settle; give layers.duration, or remove them");
  const bool all =
      !in.strata.empty() && std::ranges::all_of(in.strata, [](const Stratum& s) { return !s.shares.empty(); });
  double sum = 0.0;
  for (const Component& of : in.components) sum += of.share;
  if (!all && !(sum > 0.0))
    fail(tables.components.front().place, "component.share", "is missing; give the share of each component");
}

/// What of all components the rest of the program asks for as if it were one: the stiffest and lightest, which have the
/// shortest steps, and the sizes of all.
void envelop(Input& in) {
  Particles all = in.components.front().particles;
  Radius sizes;
  sizes.distribution = SizeDistribution::mixture;
  sizes.weighting = in.mixture.share_by == "number" ? Weighting::number : Weighting::mass;
  const auto weight = [&](std::size_t k) {  // of a component in the whole pack, by its shares and the strata's heights
    double share = 0.0, below = 0.0;
    for (const Stratum& s : in.strata) {
      const double end = s.top.value_or(in.container.size.back());
      const double part = s.mass ? *s.mass : end - below;
      double sum = 0.0;
      for (std::size_t c = 0; c < in.components.size(); ++c) sum += share_in(in, s, c);
      share += part * share_in(in, s, k) / sum;
      below = end;
    }
    return in.strata.empty() ? in.components[k].share : share;
  };
  for (std::size_t k = 0; k < in.components.size(); ++k) {
    const Particles& of = in.components[k].particles;
    all.density = std::min(all.density, of.density);
    all.youngs_modulus = std::max(all.youngs_modulus, of.youngs_modulus);
    if (std::abs(of.poisson_ratio) > std::abs(all.poisson_ratio)) all.poisson_ratio = of.poisson_ratio;
    const double share = weight(k) / (in.mixture.share_by == "mass" ? of.density : 1.0);
    if (!(share > 0.0)) continue;
    sizes.parts.push_back(of.radius);
    sizes.shares.push_back(share);
  }
  all.count = 0;
  all.radius = std::move(sizes);
  in.particles = std::move(all);
}

std::string effective_component(const Input& in, const Component& of) {
  Input part = in;
  part.particles = of.particles;
  part.components.clear();
  std::string text =
      fmt::format("\n[[component]]\nname = {}\nshare = {}\n", toml_string(of.name), tables::number(of.share));
  std::string radius;
  for (const Key& key : keys()) {
    if (!key.path.starts_with("particles.") || key.path == "particles.count" || !key.applies(part)) continue;
    const auto [table, name] = split_path(key.path);
    (table == "particles" ? text : radius) += fmt::format("{} = {}\n", name, written(key, part));
  }
  text += fmt::format("friction = {}\nwall_friction = {}\ndamping_ratio = {}\n", tables::number(of.friction),
                      tables::number(of.wall_friction), tables::number(of.damping_ratio));
  if (in.contact.tangential == Tangential::mindlin) {
    text += fmt::format("rolling_friction = {}\ntwisting_friction = {}\n", tables::number(of.rolling_friction),
                        tables::number(of.twisting_friction));
  }
  return text + "[component.radius]\n" + radius;
}

}  // namespace

MixtureTables split_mixture(Document& document) {
  MixtureTables tables{
      tables_at(document, "component"), tables_at(document, "pair"), tables_at(document, "stratum"), {}};
  if (tables.components.empty()) {
    for (const auto& [name, list] : {std::pair("pair", &tables.pairs), std::pair("stratum", &tables.strata)}) {
      if (!list->empty()) fail(list->front().place, name, "is of components; give [[component]], too");
    }
    return tables;
  }
  std::vector<std::string_view> names{"name", "share"};
  names.insert(names.end(), of_particles.begin(), of_particles.end());
  names.insert(names.end(), of_contact.begin(), of_contact.end());
  for (const Node& table : tables.components) refuse_unknown_in(table, "component", names);
  if (std::ssize(tables.components) > most_components)
    fail(tables.components.back().place, "component",
         fmt::format("there are {}; {} are possible at most", tables.components.size(), most_components));
  const Node& first = tables.components.front();
  tables.particles = document.take("particles");
  const Node* base = tables.particles ? &*tables.particles : nullptr;
  document.put("particles", merged(base, first, of_particles));
  if (tables.components.size() > 1) return tables;
  (void)named(first);
  if (!tables.pairs.empty())
    fail(tables.pairs.front().place, "pair", "is of two components, and there is one; remove it");
  if (!tables.strata.empty())
    fail(tables.strata.front().place, "stratum", "differs from others by its components, and there is one; remove it");
  if (document.find("contact") != nullptr ||
      std::ranges::any_of(table_of(first), [](const Entry& e) { return is_in(of_contact, e.name); }))
    document.put("contact", merged(document.find("contact"), first, of_contact));
  (void)document.take("mixture");
  return {};
}

void take_mixture(const MixtureTables& tables, const Document& document, Input& in) {
  if (tables.components.empty()) return;
  in.components.clear();
  for (const Node& table : tables.components)
    in.components.push_back(component_of(table, tables.particles ? &*tables.particles : nullptr, document, in));
  for (const Node& table : tables.pairs) in.pairs.push_back(pair_of(table, in));
  for (const Node& table : tables.strata) in.strata.push_back(stratum_of(table, in));
  check_strata(tables, in);
  check_mixture(tables, document, in);
  check_masses(tables, in);
  envelop(in);
}

bool is_of_component(std::string_view path) { return path.starts_with("particles."); }

std::string effective_mixture(const Input& in) {
  std::string text;
  for (const Component& of : in.components) text += effective_component(in, of);
  const auto name = [&](int k) { return toml_string(in.components[static_cast<std::size_t>(k)].name); };
  for (const ComponentPair& pair : in.pairs) {
    text += fmt::format("\n[[pair]]\ncomponents = [{}, {}]\n", name(pair.first), name(pair.second));
    const auto add = [&](const char* key, const std::optional<double>& value) {
      if (value) text += fmt::format("{} = {}\n", key, tables::number(*value));
    };
    add("friction", pair.friction), add("damping_ratio", pair.damping_ratio);
    add("rolling_friction", pair.rolling_friction), add("twisting_friction", pair.twisting_friction);
  }
  for (const Stratum& one : in.strata) {
    text += fmt::format("\n[[stratum]]\nname = {}\n", toml_string(one.name));
    if (one.top) text += fmt::format("top = {}\n", tables::number(*one.top));
    if (one.mass) text += fmt::format("mass = {}\n", tables::number(*one.mass));
    std::string shares;
    for (std::size_t k = 0; k < one.shares.size(); ++k) {
      shares += fmt::format("{}{} = {}", k == 0 ? "" : ", ", in.components[k].name, tables::number(one.shares[k]));
    }
    if (!shares.empty()) text += fmt::format("shares = {{{}}}\n", shares);
  }
  return text;
}

}  // namespace packmpi::input
