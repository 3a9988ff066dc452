/// How far a bed of several components has come: how many of each there are, and in which stratum it is.
#pragma once
#include <cstdint>
#include <vector>

#include "base/types.hpp"
#include "scene/scene.hpp"

namespace packmpi::control {

/// Part of a run's progress; the same on all ranks. With one component: nothing. Sums are exact, in the units of
/// scene/mixture.hpp.
struct Mixing {
  bool on = false;
  std::vector<std::int64_t> counts;  ///< particles of each component, layer by layer
  std::vector<std::int64_t> drawn;   ///< particles of each component
  std::vector<std::int64_t> units;   ///< what they add up to
  std::vector<std::int64_t> wanted;  ///< what they were to add up to
  double extent = 0.0;               ///< [m3] (2D: m2) solid that was asked for
  std::int64_t stratum = 0;          ///< of the next layer
  double stratum_extent = 0.0;       ///< of `extent`, in it
  std::int64_t stratum_layers = 0;   ///< inserted in it whose size was cut
  std::vector<std::int64_t> strata;  ///< of each layer
};

/// Of a scene with several components, before its first layer.
[[nodiscard]] Mixing begin_mixing(const scene::Scene& scene);

/// [m3] (2D: m2) what the next layer may have at most so that the stratum, which it goes on to the next of where this
/// one is complete, ends where it is to; infinite where the end of the bed ends it. `fraction`: what the bed's solid
/// fraction is; 0: as expected. Heights of strata become solid volumes by it, as the surface of a bed that still moves
/// says nothing of the finished pack. Pure.
[[nodiscard]] double left_in_stratum(const scene::Scene& scene, double fraction, Mixing& mixing);

/// Whether strata end with masses, and the last one has not got its own yet. Pure.
[[nodiscard]] bool wants_mass(const scene::Scene& scene, const Mixing& mixing);
/// Whether strata end with masses.
[[nodiscard]] bool by_mass(const scene::Scene& scene);

/// [kg] of each component, as its share of what was asked for; none where shares are by number, and of one component.
[[nodiscard]] std::vector<double> masses_wanted(const scene::Scene& scene, const Mixing& mixing);

/// Component of particle `id`, which is of `layer`, whose first has the id `first`. Local.
[[nodiscard]] int component_of(const Mixing& mixing, std::size_t layer, GlobalId first, GlobalId id);

}  // namespace packmpi::control
