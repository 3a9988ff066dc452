/// A small piece of a scene, on which a density is looked for. A scene alone; run/trial.hpp fills one in.
#pragma once
#include "control/filling.hpp"
#include "scene/scene.hpp"

namespace packmpi::control {

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
[[nodiscard]] Squeeze squeeze_of(const scene::Scene& scene, double surface, const Slab& slab);

/// Is the density that is ordered one under stress? Local, pure.
[[nodiscard]] bool confined_density(const scene::Scene& scene);

}  // namespace packmpi::control
