/// The container that a scene asks for.
#pragma once
#include "config/input.hpp"
#include "geometry/container.hpp"

namespace packmpi::input {

/// What is around a vessel that is no box; its sides are walls.
void take_vessel(Container& container);

/// Of a container that has been read.
[[nodiscard]] geometry::Container container_of(const Container& container);

}  // namespace packmpi::input
