/// One value between its key, its node in the file and its member of Input.
#pragma once
#include <string>

#include "document/document.hpp"
#include "input/keys.hpp"

namespace packmpi::input {

using document::Node;

/// Checks the type, unit and range of `node` against `key` and stores it. Throws Error(bad_input).
void store(const Key& key, const Node& node, Input& in);

/// Stores the key's default. The key has one.
void store_default(const Key& key, Input& in);

/// The member's value as TOML, such that store() gives the same bits back.
[[nodiscard]] std::string written(const Key& key, Input& in);

}  // namespace packmpi::input
