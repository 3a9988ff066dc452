/// What a JSON file of ours says of itself and of the pack it is of. Private to this module.
#pragma once
#include <fmt/format.h>

#include <cstdint>
#include <nlohmann/json.hpp>

#include "base/digest.hpp"

namespace packmpi::report {

/// A digest of what the object says, however it is set. Local.
[[nodiscard]] inline std::uint64_t digest_of(const nlohmann::ordered_json& root) {
  return fnv_add(fnv_start, root.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

/// As JSON files have digests: all 64 bits, which a number there may lose.
[[nodiscard]] inline std::string hexadecimal(std::uint64_t digest) { return fmt::format("{:016x}", digest); }

}  // namespace packmpi::report
