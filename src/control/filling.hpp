/// How a density is met: by the friction that layers are filled in with. A sample of the scene tells which density
/// comes of it; what finished layers measure tells how the whole bed differs from the sample (doc/theory.md, "Density
/// as a target").
#pragma once
#include <vector>

#include "input/input.hpp"
#include "scene/scene.hpp"

namespace packmpi::control {

/// The one number that is turned: 0, the least friction; 1, target.most_friction, in equal ratios between them; beyond,
/// to 2, resistance to rolling grows from the scene's own to target.most_rolling_friction. The larger, the looser.
using Knob = double;

/// What a sample came to that was filled in with one knob: solid fractions of its bulk.
struct Trial {
  Knob knob = 0.0;
  double filled = 0.0;   ///< before the final relaxation
  double relaxed = 0.0;  ///< after it, with the scene's own friction; of target.state = "confined" under the stress
  double coordination = 0.0;    ///< then
  std::vector<double> slabs{};  ///< what was measured after each layer, as of a bed that is corrected; 0: nothing was
};

/// Loosest and densest solid fraction.
struct Limits {
  double loosest = 0.0, densest = 0.0;
};

/// Where the filling of a bed with a target is: part of a run's progress. Solid fractions. Without a target: nothing.
struct Filling {
  bool on = false;
  double target = 0.0;
  Knob knob = 0.0;    ///< of the layer that is filled in next
  double bias = 0.0;  ///< what finished layers have more than the sample foresees
  // The sample's curve, in the order of knobs: what comes of them, falling.
  std::vector<double> knobs, filled, relaxed;
  // What a slab that is measured after a layer has more than the bulk when all layers are there, on the mean of the
  // sample's trials: it lies nearer to floor and surface, and its newest layers have settled for less long.
  std::vector<double> slab_excess;
  // Of each layer inserted: its knob; of each settled: the bed's surface after it [m], and the solid fraction of the
  // bed that is buried deep enough, measured then; 0: none was.
  std::vector<double> layer_knobs, layer_surfaces, layer_fractions;
};

/// Part of a bed between two heights [m].
struct Slab {
  double low = 0.0, high = 0.0;
  double weight = 0.0;  ///< how much of what it measures is believed, the rest being chance: 0 .. 1
  [[nodiscard]] double depth() const noexcept { return high - low; }
};

/// What weight, and the stress that comes after, add to the solid fraction of a bed by pressing its particles into each
/// other.
struct Squeeze {
  double sample = 0.0;   ///< in the slab that is measured of the sample after as many layers, or after its last one
  double ordered = 0.0;  ///< in the bulk of the sample, on the mean, when it has the density that is ordered: with the
                         ///< stress, if under one
  double now = 0.0;      ///< in the slab that is measured
  double next = 0.0;     ///< in the end, in the layer that is filled in next
};

/// The friction that a knob stands for. Local, pure; same bits on any machine.
[[nodiscard]] scene::Friction friction_of(const input::Input& in, Knob knob);
/// The largest knob of a scene: 2 if rolling may grow, else 1. Local.
[[nodiscard]] Knob loosest_knob(const input::Input& in);

/// The solid fraction that a target of [target] stands for; `limits` are asked for only by relative_density. Local.
[[nodiscard]] double fraction_wanted(const input::Target& target, const Limits& limits);

/// The curve of trials, which come in any order: those of nearly the same knob count as one, their mean, and it is made
/// to fall where chance lets it rise (isotonic regression), so that every density has a knob, and none hangs on the
/// chance of two trials side by side. Without target and knob. Local.
[[nodiscard]] Filling curve_of(std::vector<Trial> trials);
[[nodiscard]] Limits limits_of(const Filling& curve);
/// The knob at which the curve of the relaxed sample is `fraction`, linear between trials; the nearest end's beyond.
[[nodiscard]] Knob knob_for(const Filling& curve, double fraction);
/// The curve before relaxation, at a knob.
[[nodiscard]] double filled_at(const Filling& curve, Knob knob);

/// What is measured after a layer of a bed of that surface [m]: the uppermost part of it that is buried and not next to
/// the floor. No depth: the bed is too low yet. Local.
[[nodiscard]] Slab buried(double surface, double mean_diameter);
/// After a layer has settled: what its slab measured, beside what the curve foresees of the knobs its parts were filled
/// in with and of the weight above it, corrects the next knob. A slab of no depth gives no correction but for the
/// weight; without a curve nothing changes. Local.
void correct(Filling& filling, double surface, const Slab& slab, double measured, const Squeeze& squeeze);
/// The knob of the next layer. Local.
[[nodiscard]] Knob next_knob(const Filling& filling, const Squeeze& squeeze);

}  // namespace packmpi::control
