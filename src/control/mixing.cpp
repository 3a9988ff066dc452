#include "control/mixing.hpp"

#include <limits>

#include "scene/expectation.hpp"
#include "scene/mixture.hpp"

namespace packmpi::control {
namespace {

// A stratum by height is complete if less than this of a mean diameter is missing, and after so many layers that were
// cut to its rest.
constexpr double near_enough = 0.25;
constexpr std::int64_t most_cuts = 5;
// One by mass, when so small a part of it is left: its last layer was cut to it.
constexpr double rounding = 1e-9;

// The solid extent that a stratum's mass is.
double extent_of_mass(const scene::Recipe& recipe, double mass) {
  return mass / recipe.density / recipe.mean_volume * recipe.mean_extent;
}

// What is left of stratum k; not above zero: it is complete.
double left(const scene::Scene& scene, std::size_t k, double fraction, const Mixing& mixing) {
  const input::Stratum& stratum = scene.in.strata[k];
  const scene::Recipe recipe = scene::recipe_of(scene, k);
  if (stratum.mass) {
    const double whole = extent_of_mass(recipe, *stratum.mass);
    const double rest = whole - mixing.stratum_extent;
    return rest > rounding * whole ? rest : 0.0;
  }
  const geometry::Container& vessel = scene.container;
  const double share = fraction > 0.0 ? fraction : scene::expected_fraction(scene).value;
  const double a_metre = (vessel.straight() ? vessel.mean_area() : vessel.area_at(*stratum.top)) * share;
  const double wanted = vessel.straight() ? *stratum.top * a_metre : vessel.volume_between(0.0, *stratum.top) * share;
  const double missing = wanted - mixing.extent;
  const bool complete = missing < near_enough * 2.0 * scene.sizes.mean() * a_metre;
  return complete || mixing.stratum_layers >= most_cuts ? 0.0 : missing;
}

}  // namespace

Mixing begin_mixing(const scene::Scene& scene) {
  Mixing mixing;
  mixing.on = scene.features.mixture;
  if (!mixing.on) return mixing;
  const std::size_t count = scene.in.components.size();
  mixing.drawn.assign(count, 0);
  mixing.units.assign(count, 0);
  mixing.wanted.assign(count, 0);
  return mixing;
}

bool by_mass(const scene::Scene& scene) { return !scene.in.strata.empty() && scene.in.strata.front().mass.has_value(); }

double left_in_stratum(const scene::Scene& scene, double fraction, Mixing& mixing) {
  constexpr double endless = std::numeric_limits<double>::infinity();
  const std::vector<input::Stratum>& strata = scene.in.strata;
  for (;;) {
    const auto k = static_cast<std::size_t>(mixing.stratum);
    const bool last = k + 1 >= strata.size();
    if (strata.empty() || (last && !strata[k].mass)) return endless;
    const double rest = left(scene, k, fraction, mixing);
    if (rest > 0.0 || last) return rest;
    ++mixing.stratum;
    mixing.stratum_extent = 0.0;
    mixing.stratum_layers = 0;
  }
}

bool wants_mass(const scene::Scene& scene, const Mixing& mixing) {
  if (!by_mass(scene)) return false;
  Mixing next = mixing;
  return left_in_stratum(scene, 0.0, next) > 0.0;
}

std::vector<double> masses_wanted(const scene::Scene& scene, const Mixing& mixing) {
  std::vector<double> masses;
  if (!mixing.on || scene::by_number(scene)) return masses;
  for (std::size_t k = 0; k < mixing.wanted.size(); ++k) {
    masses.push_back(static_cast<double>(mixing.wanted[k]) * scene::volume_unit(scene) *
                     scene.in.components[k].particles.density);
  }
  return masses;
}

int component_of(const Mixing& mixing, std::size_t layer, GlobalId first, GlobalId id) {
  const std::size_t components = mixing.drawn.size();
  GlobalId end = first;
  for (std::size_t k = 0; k + 1 < components; ++k) {
    end += mixing.counts[layer * components + k];
    if (id < end) return static_cast<int>(k);
  }
  return static_cast<int>(components) - 1;
}

}  // namespace packmpi::control
