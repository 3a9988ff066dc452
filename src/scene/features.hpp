/// Which parts of the model a scene uses.
#pragma once
#include "particles/layout.hpp"

namespace packmpi::scene {

/// Picks the compiled kernel, the record layout and what a contact remembers. What is off costs nothing.
struct Features {
  int dimension = 3;
  bool rotation = true;
  bool friction = true;  ///< mu > 0 at particles or walls
  bool drag = true;      ///< coefficient > 0
  bool near_field = false;
  bool graded = false;    ///< radii differ
  bool periodic = false;  ///< any lateral axis
  bool memory = false;    ///< friction with memory: each contact keeps its tangential displacement; implies friction
  bool rolling = false;   ///< resistance to rolling or twisting; implies memory and rotation
  bool mixture = false;   ///< particles of several components; implies graded
  /// Classes of size for the neighbour search, each half as large as the one before; 1: radii are alike, one search
  int size_levels = 1;

  [[nodiscard]] constexpr particles::Layout layout() const {
    return particles::layout_of(dimension, rotation, mixture);
  }
  friend constexpr bool operator==(const Features&, const Features&) = default;
};

}  // namespace packmpi::scene
