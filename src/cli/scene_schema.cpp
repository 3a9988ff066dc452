#include "cli/scene_schema.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "input/keys.hpp"

namespace packmpi::cli {
namespace {

using Json = nlohmann::ordered_json;
using input::Key;

Json number(const Key& key, const char* type) {
  Json schema{{"type", type}};
  if (std::isfinite(key.range.low)) schema[key.range.low_open ? "exclusiveMinimum" : "minimum"] = key.range.low;
  if (std::isfinite(key.range.high)) schema[key.range.high_open ? "exclusiveMaximum" : "maximum"] = key.range.high;
  return schema;
}

// A number, or text with a unit ("20 mm"), or "auto".
Json quantity(const Key& key) { return {{"anyOf", Json::array({number(key, "number"), {{"type", "string"}}})}}; }

// One value of the key, or one entry of its list.
template <class Value>
Json value_schema(const Key& key) {
  if constexpr (std::is_same_v<Value, bool>) {
    return {{"type", "boolean"}};
  } else if constexpr (std::is_integral_v<Value>) {
    return number(key, "integer");
  } else if constexpr (std::is_same_v<Value, double> || std::is_same_v<Value, std::optional<double>>) {
    return quantity(key);
  } else if constexpr (std::is_same_v<Value, std::string> || std::is_enum_v<Value>) {
    const auto words = input::choices(key);
    if (words.empty()) return {{"type", "string"}};
    return {{"enum", words}};
  } else {
    return Json::object();  // whatever the reader takes
  }
}

Json list_schema(const Json& entry) { return {{"type", "array"}, {"items", entry}}; }

Json schema_of(const Key& key) {
  input::Input sample;
  sample.near_field.emplace();
  sample.start.emplace();
  sample.target.emplace();
  sample.confinement.emplace();
  Json schema = std::visit(
      [&](const auto* slot) -> Json {
        using Value = std::remove_cvref_t<decltype(*slot)>;
        if constexpr (std::is_same_v<Value, Vec3>) {
          return list_schema(value_schema<double>(key));
        } else if constexpr (requires { typename Value::value_type; } && !std::is_same_v<Value, std::string> &&
                             !std::is_same_v<Value, std::optional<double>>) {
          return list_schema(value_schema<typename Value::value_type>(key));
        } else {
          return value_schema<Value>(key);
        }
      },
      key.slot(sample));
  std::string meaning(key.doc);
  if (!key.unit.empty()) meaning += " [" + std::string(key.unit) + "]";
  if (!key.when.words.empty()) meaning += " Only if " + std::string(key.when.words) + ".";
  schema["description"] = meaning;
  return schema;
}

// The object of a table's path, made with its parents.
Json& table_at(Json& root, std::string_view path) {
  Json* here = &root;
  while (!path.empty()) {
    const std::size_t dot = path.find('.');
    Json& table = (*here)["properties"][std::string(path.substr(0, dot))];
    if (table.is_null()) table = {{"type", "object"}, {"additionalProperties", false}, {"properties", Json::object()}};
    here = &table;
    path.remove_prefix(dot == std::string_view::npos ? path.size() : dot + 1);
  }
  return *here;
}

// A key without a default must be there, and so must the tables it is in.
void require(Json& root, std::string_view path) {
  const std::size_t dot = path.rfind('.');
  if (dot != std::string_view::npos) require(root, path.substr(0, dot));
  Json& table = table_at(root, dot == std::string_view::npos ? "" : path.substr(0, dot));
  const Json name(path.substr(dot + 1));
  Json& names = table["required"];
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

// What only insertion alone (layers.duration = 0) does without.
constexpr std::array<std::string_view, 3> of_layers{"layers.thickness", "layers.fraction", "jamming.gravity"};

void require_of_layers(Json& root) {
  root["required"].push_back("layers");
  root["if"]["properties"]["layers"] = {{"required", Json::array({"duration"})},
                                        {"properties", {{"duration", {{"enum", Json::array({0})}}}}}};
  const auto names = [](auto... name) { return Json{{"required", Json::array({name...})}}; };
  root["else"] = names("jamming");
  root["else"]["properties"] = {{"layers", names("thickness", "fraction")}, {"jamming", names("gravity")}};
}

// A table `diameter` may stand for `radius`.
void allow_diameters(Json& particles) {
  Json diameter = particles["properties"]["radius"];
  Json& properties = diameter["properties"];
  properties["diameters"] = properties["radii"];
  properties.erase("radii");
  particles["properties"]["diameter"] = diameter;
  Json& names = particles["required"];
  names.erase(std::remove(names.begin(), names.end(), "radius"), names.end());
  const auto with = [](const char* name) { return Json{{"required", Json::array({name})}}; };
  particles["oneOf"] = Json::array({with("radius"), with("diameter")});
}

Json array_of(Json properties, Json required) {
  return {{"type", "array"},
          {"items",
           {{"type", "object"},
            {"additionalProperties", false},
            {"properties", std::move(properties)},
            {"required", std::move(required)}}}};
}

// Arrays of tables (input/mixture.cpp); with components, [particles] need not have all that they say.
void allow_components(Json& root) {
  Json& all = root["properties"];
  const Json number{{"type", "number"}, {"minimum", 0}}, word{{"type", "string"}};
  Json component{{"name", word}, {"share", number}};
  for (const char* name : {"density", "youngs_modulus", "poisson_ratio", "radius", "diameter"})
    component[name] = all["particles"]["properties"][name];
  Json pair{{"components", {{"type", "array"}, {"items", word}, {"minItems", 2}, {"maxItems", 2}}}};
  for (const char* name : {"friction", "damping_ratio", "restitution", "rolling_friction", "twisting_friction"})
    component[name] = pair[name] = all["contact"]["properties"][name];
  component["wall_friction"] = all["contact"]["properties"]["wall_friction"];
  Json stratum{
      {"name", word}, {"top", all["layers"]["properties"]["gap"]}, {"mass", all["layers"]["properties"]["gap"]}};
  stratum["top"]["description"] = "Height where the stratum ends. [m]";
  stratum["mass"]["description"] = "What the stratum has inserted. [kg]";
  stratum["shares"] = {{"type", "object"}, {"additionalProperties", number}};
  all["component"] = array_of(component, Json::array({"name"}));
  all["pair"] = array_of(pair, Json::array({"components"}));
  all["stratum"] = array_of(stratum, Json::array());
  Json whole{{"required", all["particles"]["required"]}, {"oneOf", all["particles"]["oneOf"]}};
  all["particles"].erase("required");
  all["particles"].erase("oneOf");
  Json& required = root["required"];
  required.erase(std::remove(required.begin(), required.end(), "particles"), required.end());
  Json rule;
  rule["if"]["not"]["required"] = Json::array({"component"});
  rule["then"]["required"] = Json::array({"particles"});
  rule["then"]["properties"]["particles"] = std::move(whole);
  root["allOf"] = Json::array({rule});
}

// [[obstacle]] (input/obstacle_tables.cpp).
void allow_obstacles(Json& root) {
  const Json& container = root["properties"]["container"]["properties"];
  const Json& length = container["height"];
  const auto said = [&](const char* words) {
    Json one = length;
    one["description"] = words;
    return one;
  };
  const auto three = [](Json one) {
    return Json{{"type", "array"}, {"items", std::move(one)}, {"minItems", 3}, {"maxItems", 3}};
  };
  Json one{{"shape", {{"enum", {"sphere", "cylinder", "box", "mesh"}}}}};
  one["diameter"] = said("Of a sphere or a cylinder. [m]");
  one["length"] = said("Of a cylinder, along its axis. [m]");
  one["axis"] = {{"enum", {"x", "y", "z"}}};
  one["size"] = three(said("Extents of a box. [m]"));
  one["file"] = container["file"];
  one["unit"] = container["unit"];
  one["position"] = three(said("Of its middle. [m]"));
  one["position"]["items"].erase("exclusiveMinimum");
  root["properties"]["obstacle"] = array_of(one, Json::array({"shape"}));
}

}  // namespace

std::string scene_schema() {
  Json root{{"$schema", "http://json-schema.org/draft-07/schema#"},
            {"title", "packmpi scene"},
            {"type", "object"},
            {"additionalProperties", false},
            {"properties", Json::object()}};
  for (const Key& key : input::keys()) {
    const std::size_t dot = key.path.rfind('.');
    const std::string_view table = dot == std::string_view::npos ? "" : key.path.substr(0, dot);
    Json& object = table_at(root, table);
    object["properties"][std::string(key.path.substr(dot + 1))] = schema_of(key);
    const bool always = key.when.holds == nullptr && std::ranges::find(of_layers, key.path) == of_layers.end();
    if (!key.standard && always) require(root, key.path);
  }
  require_of_layers(root);
  allow_diameters(root["properties"]["particles"]);
  allow_components(root);
  allow_obstacles(root);
  return root.dump(2) + "\n";
}

}  // namespace packmpi::cli
