#include "report/summary.hpp"

#include <charconv>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/regular_file.hpp"
#include "report/json_seal.hpp"

namespace packmpi::report {
namespace {

using Json = nlohmann::ordered_json;

std::uint64_t number_in(const Json& seal, const char* name) {
  const std::string digits = seal.value(name, "");
  std::uint64_t number = 0;
  std::from_chars(digits.data(), digits.data() + digits.size(), number, 16);
  return number;
}

// Null for what is no regular file, or no JSON.
Json parsed(const std::string& path) {
  if (!RegularFile(path).flaw().empty()) return {};
  std::ifstream file(path);
  return Json::parse(file, nullptr, false);
}

}  // namespace

Summary read_summary(const std::string& path) {
  const auto refuse = [&](const char* words) { throw Error(ExitCode::io_failure, path + words); };
  Json root = parsed(path);
  if (!root.is_object()) refuse(" is missing, or no summary of a pack");
  const Json seal = root.value("seal", Json::object());
  root.erase("seal");
  if (number_in(seal, "summary") != digest_of(root)) {
    refuse(" is not as it was written: it was edited, or is of another version of packmpi");
  }
  Summary summary{.pack_seal = number_in(seal, "pack"),
                  .targets_met = root["achieved"]["targets_met"].get<bool>(),
                  .series_rows = root["provenance"]["series_rows"].get<std::int64_t>(),
                  .series_rows_in_file = root["provenance"]["series_rows_in_file"].get<std::int64_t>(),
                  .achieved = {}};
  for (const auto& [name, value] : root["achieved"].items()) {
    if (value.is_number()) summary.achieved[name] = value.get<double>();
  }
  return summary;
}

std::uint64_t pack_of_analysis(const std::string& path) {
  const Json root = parsed(path);
  return root.is_object() ? number_in(root.value("seal", Json::object()), "pack") : 0;
}

}  // namespace packmpi::report
