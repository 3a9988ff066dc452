/// The record as named values with units: one list that the pack file, the JSON and the table are made from.
#pragma once
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "output/record.hpp"

namespace packmpi::output {

using Value = std::variant<std::int64_t, std::uint64_t, double, bool, std::string, std::vector<double>,
                           std::vector<std::int64_t>>;

/// One value of a record. `unit` is "" for counts and words, "-" for ratios.
struct Field {
  const char* name;
  const char* unit;
  Value value;
};

[[nodiscard]] std::vector<Field> asked_fields(const RunRecord& record);
[[nodiscard]] std::vector<Field> got_fields(const RunRecord& record);
[[nodiscard]] std::vector<Field> audit_fields(const Audit& audit);
/// How it was made: versions, machine kind, ranks, times; nothing that names the host.
[[nodiscard]] std::vector<Field> provenance_fields(const RunRecord& record);

/// One column of the per-layer table.
struct LayerColumn {
  const char* name;
  const char* unit;
  std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<std::string>> values;
};
[[nodiscard]] std::vector<LayerColumn> layer_columns(const std::vector<LayerRow>& layers);

}  // namespace packmpi::output
