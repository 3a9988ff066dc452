/// What a scene comes to, before it is run: the solid fraction of its bed, its layers and its particles. Estimates,
/// from what packs came to that were made (doc/estimate.md).
#pragma once
#include <cstdint>
#include <optional>

#include "scene/scene.hpp"

namespace packmpi::scene {

/// Solid volume of a settled bed over floor area times height, the height by layers.height; and what it may be off by.
struct BedFraction {
  double value = 0.0;
  double error = 0.0;
};
/// Known: spheres and discs, with and without rotation, at friction 0, 0.2 and 0.5, between which it is linear; wider
/// size distributions are added by their standard deviation and skewness. Local, pure.
[[nodiscard]] BedFraction expected_fraction(const Scene& scene);

/// Particles that fill a layer to its fraction; exact for equal radii, else the mean over seeds. Local, pure.
[[nodiscard]] std::int64_t particles_a_layer(const Scene& scene);

/// Standard deviation of the number of particles over seeds, of so many: radii are drawn until their volume is enough.
/// sqrt(N) times the coefficient of variation of the volume (renewal theory, for many); 0 for equal radii.
[[nodiscard]] double deviation_of_count(const Scene& scene, double particles);

/// What the finest part of a grading curve by mass comes to.
struct Fines {
  double part = 0.0;       ///< [-] by mass
  double diameter = 0.0;   ///< [m] below which they are
  double share = 0.0;      ///< of the particles
  double particles = 0.0;  ///< of the scene, in all
  double without = 0.0;    ///< of the scene without them, at the same solid volume
};
/// None: the sizes are not a grading curve by mass, nor those of a component. Local, pure.
[[nodiscard]] std::optional<Fines> fines(const Scene& scene, double part = 0.05);

/// Height [m] by which a layer raises a bed of this solid fraction.
[[nodiscard]] double rise_of_layer(const Scene& scene, double fraction);

/// Layers that fill the scene's height, or hold its number of particles, at this solid fraction; layers.maximum at
/// most.
[[nodiscard]] std::int64_t expected_layers(const Scene& scene, double fraction);

/// What a scene is filled with.
struct Filling {
  std::int64_t layers = 0, particles = 0;
  double height = 0.0;           ///< [m]
  std::int64_t uncertainty = 0;  ///< particles more or less that the last layer may come to, at a known fraction
};
/// At this solid fraction: the number of particles asked for; insertion alone; whole layers until the bed has the
/// scene's height; or with layers.region = "container" what fits below it, the last layers ever thinner. Local, pure.
[[nodiscard]] Filling expected_filling(const Scene& scene, double fraction);

/// Height [m] of the bed below H_d with layers.region = "container": the roughness of its surface is left, and half of
/// the diameter that no layer fits into any more.
[[nodiscard]] double height_below(const Scene& scene, double target);

/// [m] of the bed when it is finished: H_d, or what the count or layers.maximum come to. Local, pure.
[[nodiscard]] double finished_height(const Scene& scene);

/// How deep a pile without walls presses as much as this one does at `depth` [m] below its surface (Janssen 1895): side
/// walls bear the rest. Same bits on any machine.
[[nodiscard]] double pressing_depth(const Scene& scene, double depth);

/// Mean overlap of touching particles over their radius where a pile without walls is so deep [m], at this modulus
/// [Pa]. 0 without gravity. Same bits on any machine.
[[nodiscard]] double overlap_below(const Scene& scene, double pressing, double youngs_modulus);

/// Mean overlap of touching particles over their radius in a bed of the scene's height that rests under its weight, at
/// this modulus [Pa]: Hertz contacts under the mean force that bears what is above, depth by depth; side walls bear
/// what Janssen's formula gives them. Within a fifth of what packs come to (doc/theory.md, "Rest"). 0 without gravity.
[[nodiscard]] double expected_overlap(const Scene& scene, double youngs_modulus);

/// The modulus [Pa] of which it is `overlap`, from one of any other: overlaps go with E^(-2/3).
[[nodiscard]] double modulus_for(const Scene& scene, double overlap, double youngs_modulus);

/// Mean stress [Pa] that [confinement] asks for; of sides that stay where they are about half of the vertical one.
[[nodiscard]] double mean_stress(const input::Confinement& asked);
/// Mean overlap of touching particles over their radius under the stress of [confinement], likewise; 0 without.
[[nodiscard]] double confined_overlap(const Scene& scene);

}  // namespace packmpi::scene
