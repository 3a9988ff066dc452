#include <nlohmann/json.hpp>

#include "report/composition_words.hpp"
#include "report/fields.hpp"
#include "report/json_seal.hpp"
#include "report/report.hpp"
#include "report/size_words.hpp"

namespace packmpi::report {
namespace {

using Json = nlohmann::ordered_json;

Json to_object(const std::vector<disk::Field>& fields) {
  Json object = Json::object();
  for (const disk::Field& field : fields)
    std::visit([&](const auto& value) { object[field.name] = value; }, field.value);
  return object;
}

void add_units(Json& units, const std::vector<disk::Field>& fields) {
  for (const disk::Field& field : fields) {
    if (field.unit[0] != '\0') units[field.name] = field.unit;
  }
}

Json to_rows(const RunRecord& record) {
  Json rows = Json::array();
  for (std::size_t k = 0; k < record.layers.size(); ++k) rows.push_back({{"layer", k}});
  for (const LayerColumn& column : layer_columns(record)) {
    std::visit(
        [&](const auto& values) {
          for (std::size_t k = 0; k < values.size(); ++k) rows[k][column.name] = values[k];
        },
        column.values);
  }
  return rows;
}

Json to_object(const std::vector<Criterion>& criteria) {
  Json object = Json::object();
  for (const Criterion& c : criteria) {
    object[c.name] = {{"value", c.value}, {"target", c.target}, {"limit", c.limit}, {"met", c.met()}};
  }
  return object;
}

// Beyond so many ranks the file would be mostly these lists.
constexpr std::size_t most_listed = 4096;

Json to_numbers(const std::vector<RankNumbers>& all) {
  Json object = Json::object();
  for (const RankNumbers& numbers : all) {
    Json& entry = object[numbers.name];
    if (!numbers.unit.empty()) entry["unit"] = numbers.unit;
    entry["sum"] = numbers.sum();
    entry["max"] = numbers.max();
    entry["max_over_mean"] = numbers.imbalance();
    if (numbers.of_rank.size() <= most_listed) entry["of_rank"] = numbers.of_rank;
  }
  return object;
}

}  // namespace

std::string to_json(const RunRecord& record) {
  Json units = Json::object();
  for (const auto& fields : {target_fields(record), achieved_fields(record), audit_fields(record.audit)})
    add_units(units, fields);
  for (const LayerColumn& column : layer_columns(record)) {
    if (column.unit[0] != '\0') units[column.name] = column.unit;
  }
  for (const char* diameter : {"d10", "d30", "d50", "d60", "d90"}) units[diameter] = "m";
  Json root;
  root["format"] = "packmpi-summary";
  root["format_version"] = 2;
  root["target"] = to_object(target_fields(record));
  root["achieved"] = to_object(achieved_fields(record));
  root["sizes"] = to_json(record.sizes);
  if (!record.composition.parts.empty())
    root["composition"] = composition_to_json(record.composition, record.component_masses);
  root["audit"] = to_object(audit_fields(record.audit));
  root["rest"] = to_object(record.criteria);
  root["missed"] = record.missed;
  root["layers"] = to_rows(record);
  root["counters"] = to_numbers(record.counters);
  root["costs"] = to_numbers(record.costs);
  root["moving_share"] = moving_share(record);
  root["units"] = std::move(units);
  root["provenance"] = to_object(provenance_fields(record));
  const std::string digest = hexadecimal(digest_of(root));
  root["seal"] = {{"pack", hexadecimal(record.pack_seal)}, {"summary", digest}};
  // Text from outside may be no UTF-8; a wrong byte is replaced, not an exception at the end of a long run.
  return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace packmpi::report
