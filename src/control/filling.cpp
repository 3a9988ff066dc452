#include "control/filling.hpp"

#include <algorithm>

#include "base/elementary.hpp"
#include "base/voids.hpp"

namespace packmpi::control {
namespace {

// In mean diameters. Next to the floor a bed is layered; below its surface it is not yet pressed together. What is
// measured is a slab thick enough for its chance to be small, thin enough to tell of the newest layers.
constexpr double above_floor = 2.0, below_surface = 3.0, thickest = 16.0, thinnest = 3.0, half_believed = 2.0;

// Pool adjacent violators: the nearest falling sequence, by least squares.
std::vector<double> falling(const std::vector<double>& values) {
  struct Block {
    double sum;
    std::size_t count;
    [[nodiscard]] double mean() const { return sum / static_cast<double>(count); }
  };
  std::vector<Block> blocks;
  for (const double value : values) {
    blocks.push_back({value, 1});
    while (blocks.size() > 1 && blocks.back().mean() > blocks[blocks.size() - 2].mean()) {
      const Block last = blocks.back();
      blocks.pop_back();
      blocks.back().sum += last.sum;
      blocks.back().count += last.count;
    }
  }
  std::vector<double> out;
  for (const Block& block : blocks) out.insert(out.end(), block.count, block.mean());
  return out;
}

// Trials, ascending in their knob, with those that are nearly alike made one: they differ by chance more than by their
// knobs, and the slope between them would be chance alone. The ends stay as they are.
std::vector<Trial> distinct(const std::vector<Trial>& trials) {
  constexpr double alike = 0.06;
  std::vector<Trial> out;
  double first = 0.0, count = 0.0;  // of the last of `out`
  for (std::size_t k = 0; k < trials.size(); ++k) {
    const Trial& trial = trials[k];
    if (out.size() > 1 && k + 1 < trials.size() && trial.knob - first < alike) {
      Trial& mean = out.back();
      mean.knob += (trial.knob - mean.knob) / (count + 1.0);
      mean.filled += (trial.filled - mean.filled) / (count + 1.0);
      mean.relaxed += (trial.relaxed - mean.relaxed) / (count + 1.0);
      count += 1.0;
      continue;
    }
    out.push_back(trial);
    first = trial.knob;
    count = 1.0;
  }
  return out;
}

// y at x, of points ascending in x; constant beyond them.
double between(const std::vector<double>& x, const std::vector<double>& y, double at) {
  if (at <= x.front()) return y.front();
  for (std::size_t k = 1; k < x.size(); ++k) {
    if (at <= x[k]) return y[k - 1] + (at - x[k - 1]) / (x[k] - x[k - 1]) * (y[k] - y[k - 1]);
  }
  return y.back();
}

// By layers: the mean over the trials that have a slab then; 0 before there is any.
std::vector<double> slab_excess(const std::vector<Trial>& trials) {
  std::size_t layers = 0;
  for (const Trial& trial : trials) layers = std::max(layers, trial.slabs.size());
  std::vector<double> excess(layers, 0.0);
  for (std::size_t k = 0; k < layers; ++k) {
    double count = 0.0;
    for (const Trial& trial : trials) {
      if (k >= trial.slabs.size() || !(trial.slabs[k] > 0.0)) continue;
      count += 1.0;
      excess[k] += (trial.slabs[k] - trial.filled - excess[k]) / count;
    }
  }
  return excess;
}

// What the curve foresees of a slab: of each layer's part of it, by the layer's knob.
double foreseen(const Filling& filling, const Slab& slab) {
  double sum = 0.0, bottom = 0.0;
  for (std::size_t k = 0; k < filling.layer_surfaces.size(); ++k) {
    const double top = std::max(bottom, filling.layer_surfaces[k]);
    const double part = std::min(top, slab.high) - std::max(bottom, slab.low);
    if (part > 0.0) sum += part * filled_at(filling, filling.layer_knobs[k]);
    bottom = top;
  }
  const std::vector<double>& excess = filling.slab_excess;
  return sum / slab.depth() +
         (excess.empty() ? 0.0 : excess[std::min(filling.layer_surfaces.size(), excess.size()) - 1]);
}

}  // namespace

scene::Friction friction_of(const input::Input& in, Knob knob) {
  constexpr double least = input::least_filling_friction;
  const scene::Friction own = scene::own_friction(in.contact);
  const double most = in.target->most_friction;
  const double friction = least * elementary::power(most / least, std::clamp(knob, 0.0, 1.0));
  const double share = friction / own.particles;
  const double resistance = std::min(1.0, share);
  const double more = std::max(0.0, knob - 1.0) * (in.target->most_rolling_friction - own.rolling);
  return {friction, share * own.walls, resistance * own.rolling + more, resistance * own.twisting};
}

Knob loosest_knob(const input::Input& in) {
  return in.target->most_rolling_friction > in.contact.rolling_friction ? 2.0 : 1.0;
}

double fraction_wanted(const input::Target& target, const Limits& limits) {
  if (target.solid_fraction) return *target.solid_fraction;
  if (target.porosity) return fraction_of_porosity(*target.porosity);
  if (target.void_ratio) return fraction_of_void_ratio(*target.void_ratio);
  const double e_max = void_ratio(limits.loosest), e_min = void_ratio(limits.densest);
  return fraction_of_void_ratio(e_max - target.relative_density.value_or(0.0) * (e_max - e_min));
}

Filling curve_of(std::vector<Trial> trials) {
  std::ranges::sort(trials, {}, &Trial::knob);
  Filling curve;
  for (const Trial& trial : distinct(trials)) {
    curve.knobs.push_back(trial.knob);
    curve.filled.push_back(trial.filled);
    curve.relaxed.push_back(trial.relaxed);
  }
  curve.slab_excess = slab_excess(trials);
  curve.filled = falling(curve.filled);
  curve.relaxed = falling(curve.relaxed);
  return curve;
}

Limits limits_of(const Filling& curve) { return {curve.relaxed.back(), curve.relaxed.front()}; }

Knob knob_for(const Filling& curve, double fraction) {
  const std::vector<double>& y = curve.relaxed;
  if (fraction >= y.front()) return curve.knobs.front();
  for (std::size_t k = 1; k < y.size(); ++k) {
    if (fraction < y[k]) continue;  // then y[k] < y[k - 1]
    return curve.knobs[k - 1] + (y[k - 1] - fraction) / (y[k - 1] - y[k]) * (curve.knobs[k] - curve.knobs[k - 1]);
  }
  return curve.knobs.back();
}

double filled_at(const Filling& curve, Knob knob) { return between(curve.knobs, curve.filled, knob); }

Slab buried(double surface, double mean_diameter) {
  const double high = surface - below_surface * mean_diameter;
  const double low = std::max(above_floor * mean_diameter, high - thickest * mean_diameter);
  if (high - low < thinnest * mean_diameter) return {};
  return {low, high, (high - low) / (high - low + half_believed * mean_diameter)};
}

Knob next_knob(const Filling& filling, const Squeeze& squeeze) {
  return knob_for(filling, filling.target - filling.bias - (squeeze.next - squeeze.ordered));
}

void correct(Filling& filling, double surface, const Slab& slab, double measured, const Squeeze& squeeze) {
  filling.layer_surfaces.push_back(surface);
  filling.layer_fractions.push_back(measured);
  if (filling.knobs.empty()) return;
  if (slab.depth() > 0.0) {
    filling.bias = slab.weight * (measured - foreseen(filling, slab) - (squeeze.now - squeeze.sample));
  }
  filling.knob = next_knob(filling, squeeze);
}

}  // namespace packmpi::control
