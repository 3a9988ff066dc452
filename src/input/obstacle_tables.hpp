/// [[obstacle]]: what stands or hangs in the container.
#pragma once
#include <vector>

#include "document/document.hpp"
#include "input/input.hpp"

namespace packmpi::input {

/// Takes the tables out of the document. Throws Error(bad_input).
[[nodiscard]] std::vector<Obstacle> take_obstacle_tables(document::Document& document);

}  // namespace packmpi::input
