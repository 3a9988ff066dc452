/// A small piece of a scene, filled in with a given friction: what density comes of it.
#pragma once
#include <cstdint>

#include "control/filling.hpp"
#include "scene/scene.hpp"

namespace packmpi::run {

/// The same particles and protocol on a smaller floor and to a lower height; or the scene itself, if that is small.
struct Sample {
  scene::Scene scene;
  bool whole = false;  ///< it is the scene itself, to the bit
  double scale = 1.0;  ///< solid fraction of the scene over that of the sample, for side walls that the sample has not
  double particles = 0;  ///< roughly
};

/// Of a scene with a target. An axis that becomes shorter becomes periodic. Local, pure. Throws as scene::build().
[[nodiscard]] Sample sample_of(const scene::Scene& scene);

/// What the weight above, and a stress that is ordered with the density, will squeeze a layer by that is filled in on a
/// bed with this `surface` [m] (0: the first one), and what it squeezes the `slab` of it that is measured and the
/// sample by. Local, pure; same bits on any machine.
[[nodiscard]] control::Squeeze squeeze_of(const scene::Scene& scene, double surface, const control::Slab& slab);

/// Fills the sample in with one knob, and confines it if the target's density holds then, on this rank alone. Local: no
/// rank waits for another. Throws Error(numerical_failure) as a run would.
[[nodiscard]] control::Trial try_knob(const Sample& sample, control::Knob knob);

}  // namespace packmpi::run
