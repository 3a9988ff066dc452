#include "confine/servo.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/elementary.hpp"
#include "confine/stress.hpp"
#include "scene/expectation.hpp"
#include "scene/mixture.hpp"

namespace packmpi::confine {
namespace {

// Bulk modulus [Pa] of a random pack of rough Hertz spheres under a pressure, by mean field (Walton 1987), and what one
// -dimensional compression adds to it by the shear modulus. Of several components as if all were the most compliant.
double compression_modulus(const scene::Scene& scene, double fraction, double pressure) {
  constexpr double contacts = 5.0;
  const input::Particles p = scene::most_compliant(scene.in);
  const double nu = p.poisson_ratio;
  const double grain = p.youngs_modulus / (1.0 - nu * nu);
  const double square = contacts * fraction * grain / (2.0 * std::numbers::pi);
  const double bulk = elementary::cube_root(square * square * pressure / 18.0);
  const bool rough = scene.features.mixture ? scene.features.friction : scene.in.contact.friction > 0.0;
  const double shear = bulk * 3.0 / 5.0 * (rough ? (5.0 - 4.0 * nu) / (2.0 - nu) : 1.0);
  return bulk + 4.0 / 3.0 * shear;
}

/// Of several components, before sides moved: the same from a checkpoint on.
double fraction_before(const scene::Scene& scene) {
  if (!scene.container.is_box()) return scene::expected_fraction(scene).value;
  scene::Scene before = scene;
  for (int a = 0; a < scene.container.lateral_axes(); ++a) {
    const auto axis = static_cast<std::size_t>(a);
    before.container.size[axis] = scene.in.container.size[axis];
  }
  return scene::expected_fraction(before).value;
}

}  // namespace

Gains gains_of(const scene::Scene& scene, double height, double mass) {
  constexpr double share = 0.1;  // of the stress asked for: what a wave of the closing speed brings
  const input::Confinement& asked = *scene.in.confinement;
  const double most = std::max(asked.on_lid(), asked.on_sides().value_or(0.0));
  Gains gains;
  double space = thickness(scene) * height, longest = height;
  for (int a = 0; a < scene.container.lateral_axes(); ++a) {
    const double side = scene.in.container.size[static_cast<std::size_t>(a)];
    space *= side;
    if (asked.on_sides()) longest = std::max(longest, side);  // else no waves are sent that way
  }
  if (!scene.container.is_box()) space = thickness(scene) * scene.container.volume_between(0.0, height);
  gains.density = mass / space;
  const double fraction = scene.features.mixture ? fraction_before(scene) : gains.density / scene.in.particles.density;
  gains.modulus = compression_modulus(scene, fraction, scene::mean_stress(asked));
  gains.impedance = std::sqrt(gains.density * gains.modulus);
  gains.closing = share * most / gains.impedance;
  gains.crossing = longest * std::sqrt(gains.density / gains.modulus);
  return gains;
}

std::int64_t lid_tick(const scene::Scene& scene, const Gains& gains) {
  constexpr double share = 0.1, most = 10.0;  // of the time that a wave takes through a particle; steps
  const double through = 2.0 * scene.sizes.smallest() * std::sqrt(gains.density / gains.modulus);
  return static_cast<std::int64_t>(std::clamp(std::floor(share * through / scene.confining_step), 1.0, most));
}

std::int64_t side_tick(const scene::Scene& scene, const Gains& gains) {
  constexpr double share = 0.05, least = 10.0, most = 1000.0;
  double shortest = HUGE_VAL;
  for (int a = 0; a < scene.container.lateral_axes(); ++a) {
    shortest = std::min(shortest, scene.in.container.size[static_cast<std::size_t>(a)]);
  }
  const double across = shortest * std::sqrt(gains.density / gains.modulus);
  return static_cast<std::int64_t>(std::clamp(std::floor(share * across / scene.confining_step), least, most));
}

std::int64_t expected_steps(const scene::Scene& scene, double height, double mass) {
  if (!scene.in.confinement) return 0;
  // Over the rough surface, and what beds were strained by; then crossings (doc/estimate.md has figures).
  constexpr double roughness = 0.6, vertical_strain = 0.01, lateral_strain = 0.012, crossings = 30.0;
  const Gains gains = gains_of(scene, height, mass);
  double way = roughness * 2.0 * scene.sizes.mean() + vertical_strain * height;
  if (scene.in.confinement->on_sides()) {
    for (int a = 0; a < scene.container.lateral_axes(); ++a) {
      way = std::max(way, lateral_strain * scene.in.container.size[static_cast<std::size_t>(a)]);
    }
  }
  return std::llround((way / gains.closing + crossings * gains.crossing) / scene.confining_step);
}

double lid_mass(const scene::Scene& scene, const Gains& gains) { return gains.density * 2.0 * scene.sizes.largest(); }

double side_mass(const scene::Scene& scene, const Gains& gains, std::size_t axis) {
  if (!scene.container.periodic[axis]) return lid_mass(scene, gains);
  return 0.25 * gains.density * scene.in.container.size[axis];
}

double next_speed(const Gains& gains, double areal_mass, double speed, double excess, double seconds) {
  const double rate = seconds / areal_mass;
  const double next = (speed + rate * excess) / (1.0 + rate * gains.impedance);
  return std::clamp(next, -gains.closing, gains.closing);
}

}  // namespace packmpi::confine
