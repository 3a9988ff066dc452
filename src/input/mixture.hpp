/// [[component]], [[pair]] and [[stratum]]: arrays of tables, which the key table has not. A component is read as the
/// only material of a scene of its own, by the same keys, so that every check of a scene is one of each component.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "document/document.hpp"
#include "input/input.hpp"

namespace packmpi::input {

using document::Document;
using document::Node;

/// The tables of a scene, as they are written.
struct MixtureTables {
  std::vector<Node> components, pairs, strata;
  std::optional<Node> particles;  ///< [particles], from which components have what they do not say
};

/// Takes the tables out of the document, which has the first component as its [particles] then; of one component it is
/// all there is, and the scene is one without any. Throws Error(bad_input).
[[nodiscard]] MixtureTables split_mixture(Document& document);

/// Reads them into `in`, of which all else is read. Throws Error(bad_input).
void take_mixture(const MixtureTables& tables, const Document& document, Input& in);

/// Whether the key at this path is one of each component, and not of the scene, where there are several.
[[nodiscard]] bool is_of_component(std::string_view path);

/// The tables with every default filled in; "" without components.
[[nodiscard]] std::string effective_mixture(const Input& in);

/// A scene of one component (input/read.cpp). Throws Error(bad_input).
[[nodiscard]] Input parse_part(Document document, const std::string& path);

}  // namespace packmpi::input
