/// Several components in one pack: their codes, what two of them make of a contact, and how many of each there are.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geometry/volume.hpp"
#include "particles/store.hpp"
#include "scene/scene.hpp"

namespace packmpi::scene {

/// Codes of components such that the sum of any two names the pair, whichever comes first: a record's fields are added
/// over a pair (Mian and Chowla's sequence, less one).
inline constexpr std::array<int, input::most_components> component_codes{0, 1, 3, 7, 12, 20, 30, 44};
inline constexpr int wall_codes = component_codes.back() + 1;      ///< codes of a particle alone are below
inline constexpr int pair_codes = 2 * component_codes.back() + 1;  ///< codes of a pair are below

[[nodiscard]] constexpr int code_of(int component) { return component_codes.at(static_cast<std::size_t>(component)); }
/// The component of a record's code; most_components if there is none.
[[nodiscard]] int component_of(double code) noexcept;

/// What a particle of a component is made of, and its mass as a sphere. Local.
[[nodiscard]] particles::Substance substance_of(const input::Input& in, int component, double radius);

/// [kg] of a particle; a disc's is that of its sphere.
[[nodiscard]] inline double mass_of(const Scene& scene, const particles::Store& store, LocalIndex i) {
  if (scene.features.mixture) return 1.0 / store.substance(i).inverse_mass;
  return scene.in.particles.density * geometry::volume(3, store.radius(i));
}

/// The codes of contacts for dynamics::Law::of_pair and of_wall; 0 where there is one component.
[[nodiscard]] inline double pair_code(const particles::Store& store, LocalIndex i, LocalIndex j) {
  return store.layout().component < 0 ? 0.0 : store.substance(i).code + store.substance(j).code;
}
[[nodiscard]] inline double wall_code(const particles::Store& store, LocalIndex i) {
  return store.layout().component < 0 ? 0.0 : store.substance(i).code;
}

/// What two materials make of a contact.
struct PairMaterial {
  double normal_modulus = 0.0;  ///< [Pa] E*
  double shear_modulus = 0.0;   ///< [Pa] G*
  double damping_ratio = 0.0;   ///< [-]
  Friction friction;
};

/// Of components a and b, the same for b and a: E* and G* are Hertz' and Mindlin's, 1/E* = sum of (1 - nu^2)/E and
/// 1/G* = sum of (2 - nu)/G. The ratio of damping and the coefficients of friction, rolling and twisting are what a
/// [[pair]] says, else the geometric mean of those of a and b (doc/howto_mixture.md). Local, pure.
[[nodiscard]] PairMaterial pair_material(const input::Input& in, int a, int b);
/// Of component a and a wall: its own wall_friction, damping, rolling and twisting; a wall is rigid or of its material.
[[nodiscard]] PairMaterial wall_material(const input::Input& in, int a);

/// Largest density there is [kg/m3].
[[nodiscard]] double densest(const input::Input& in);
/// Modulus [Pa] and density [kg/m3] of the component that overlaps most under its own weight.
[[nodiscard]] input::Particles softest(const input::Input& in);
/// Of the component whose contacts yield most to a force.
[[nodiscard]] input::Particles most_compliant(const input::Input& in);
/// The material whose overlaps are the largest: under its weight, or the stress of [confinement]; and how messages name
/// the key of its modulus.
[[nodiscard]] input::Particles limiting(const input::Input& in);
[[nodiscard]] std::string limiting_key(const input::Input& in);

/// What a stratum is made of, or all of a pack without strata.
struct Recipe {
  std::vector<double> numbers;  ///< [-] share of each component among the particles
  std::vector<double> volumes;  ///< [-] and of the solid volume, as spheres
  double mean_volume = 0.0;     ///< [m3] of a particle as a sphere
  double mean_extent = 0.0;     ///< the same, in 2D [m2] of a disc
  double density = 0.0;         ///< [kg/m3] mean by volume
};

/// Of the shares as the scene gives them. Local.
[[nodiscard]] Recipe recipe_of(const Scene& scene, const std::vector<double>& shares);
/// Of stratum k; of the whole without strata.
[[nodiscard]] Recipe recipe_of(const Scene& scene, std::size_t stratum);

/// So many units stand for one particle where shares are by number.
inline constexpr std::int64_t units_a_particle = std::int64_t{1} << 20;
/// Whether shares are by number, and the exact sums of the mixture count particles rather than volume.
[[nodiscard]] inline bool by_number(const Scene& scene) { return scene.in.mixture.share_by == "number"; }
/// [m3] one unit of the exact sums of volume: a power of two, 2^-32 of the largest sphere's volume or less.
[[nodiscard]] double volume_unit(const Scene& scene);
/// Volume [m3] of a particle in those units, the nearest whole number.
[[nodiscard]] std::int64_t volume_units(const Scene& scene, double radius);
/// What a particle counts in the mixture's exact sums: its volume, or units_a_particle where shares are by number.
[[nodiscard]] std::int64_t units_of(const Scene& scene, double radius);
/// Radius [m] of particle `number` (0 .., over all layers) of a component.
[[nodiscard]] double radius_of(const Scene& scene, int component, std::uint64_t number);

}  // namespace packmpi::scene
