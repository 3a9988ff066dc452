#include "report/summary.hpp"

#include <charconv>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "base/regular_file.hpp"
#include "report/json_seal.hpp"

namespace packmpi::report {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t longest = std::int64_t{64} << 20;  // bytes; a thousand layers take less than 1 MiB

// Null for what is no regular file, too long, or no JSON.
Json parsed(const std::string& path) {
  const RegularFile file(path);
  const std::optional<std::string> text = file.flaw().empty() ? file.read(0, longest + 1) : std::nullopt;
  if (!text || std::ssize(*text) > longest) return {};
  return Json::parse(*text, nullptr, false);
}

// A number of the seal at the end of a summary or an analysis, of hexadecimal digits; 0 without it.
std::uint64_t number_in(const Json& root, const char* name) {
  const auto seal = root.find("seal");
  if (seal == root.end() || !seal->is_object()) return 0;
  const auto digits = seal->find(name);
  std::uint64_t number = 0;
  if (digits == seal->end() || !digits->is_string()) return 0;
  const auto& text = digits->get_ref<const std::string&>();
  std::from_chars(text.data(), text.data() + text.size(), number, 16);
  return number;
}

Summary summary_of(const Json& root, std::uint64_t pack_seal) {
  const Json& achieved = root.at("achieved");
  const Json& provenance = root.at("provenance");
  Summary summary{.pack_seal = pack_seal,
                  .targets_met = achieved.at("targets_met").get<bool>(),
                  .series_rows = provenance.at("series_rows").get<std::int64_t>(),
                  .series_rows_in_file = provenance.at("series_rows_in_file").get<std::int64_t>(),
                  .achieved = {}};
  for (const auto& [name, value] : achieved.items()) {
    if (value.is_number()) summary.achieved[name] = value.get<double>();
  }
  return summary;
}

}  // namespace

Summary read_summary(const std::string& path) {
  const auto refuse = [&](const char* words) { throw Error(ExitCode::io_failure, path + words); };
  Json root = parsed(path);
  if (!root.is_object()) refuse(" is missing, or no summary of a pack");
  const std::uint64_t sealed = number_in(root, "summary"), pack = number_in(root, "pack");
  root.erase("seal");
  const char* const other = " is not as it was written: it was edited, or is of another version of packmpi";
  if (sealed != digest_of(root)) refuse(other);
  try {
    return summary_of(root, pack);
  } catch (const Json::exception&) {  // anybody can make a seal
    throw Error(ExitCode::io_failure, path + other);
  }
}

std::uint64_t pack_of_analysis(const std::string& path) {
  const Json root = parsed(path);
  return root.is_object() ? number_in(root, "pack") : 0;
}

}  // namespace packmpi::report
