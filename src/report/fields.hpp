/// The record as named values with units: one list that the pack file, the JSON and the table are made from.
#pragma once
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "disk/attribute.hpp"
#include "report/record.hpp"

namespace packmpi::report {

[[nodiscard]] std::vector<disk::Field> target_fields(const RunRecord& record);
[[nodiscard]] std::vector<disk::Field> achieved_fields(const RunRecord& record);
[[nodiscard]] std::vector<disk::Field> audit_fields(const Audit& audit);
/// How it was made: versions, machine kind, ranks, times; nothing that names the host.
[[nodiscard]] std::vector<disk::Field> provenance_fields(const RunRecord& record);

/// One column of the per-layer table.
struct LayerColumn {
  const char* name;
  const char* unit;
  std::variant<std::vector<std::int64_t>, std::vector<double>, std::vector<std::string>> values;
};
[[nodiscard]] std::vector<LayerColumn> layer_columns(const RunRecord& record);

}  // namespace packmpi::report
