/// The container that a scene asks for.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "config/input.hpp"
#include "document/document.hpp"
#include "geometry/container.hpp"

namespace packmpi::input {

/// What is around a vessel that is no box; its sides are walls. Throws Error(bad_input).
void take_vessel(const document::Document& document, Container& container);

/// Corners of a convex polygon, `most` of them, anticlockwise; moved so that their lowest coordinates are 0. Throws
/// Error(bad_input), with what else there is.
[[nodiscard]] Curve corners_of(const document::Document& document, Curve corners, std::size_t most,
                               std::string_view otherwise);

/// A key and what is wrong with it.
struct Flaw {
  const char* key;
  std::string words;
};
/// Of a trapezium or polygon for particles of this radius [m]: the largest lies at both ends of a trapezium; H_d is
/// inside a polygon that has room at all.
[[nodiscard]] std::optional<Flaw> flaw_of_sides(const Container& container, double radius);

/// Of a container that has been read.
[[nodiscard]] geometry::Container container_of(const Container& container);

}  // namespace packmpi::input
