#include "scene/mixture.hpp"

#include <algorithm>
#include <cmath>

namespace packmpi::scene {
namespace {

using input::Component;
using input::Input;
using input::Particles;

double normal_compliance(const Particles& of) {
  return (1.0 - of.poisson_ratio * of.poisson_ratio) / of.youngs_modulus;
}

// (2 - nu) / G with G = E / (2 (1 + nu)).
double shear_compliance(const Particles& of) {
  return 2.0 * (2.0 - of.poisson_ratio) * (1.0 + of.poisson_ratio) / of.youngs_modulus;
}

// The material of which `measure` is largest; the one of a scene without components.
template <class Measure>
Particles most_of(const Input& in, Measure&& measure) {
  if (in.components.empty()) return in.particles;
  const auto of = [&](const Component& one) { return measure(one.particles); };
  return std::ranges::max_element(in.components, {}, of)->particles;
}

const Component& component(const Input& in, int k) { return in.components[static_cast<std::size_t>(k)]; }

}  // namespace

int component_of(double code) noexcept {
  const auto found = std::ranges::find(component_codes, static_cast<int>(code));
  return static_cast<int>(found - component_codes.begin());
}

particles::Substance substance_of(const Input& in, int k, double radius) {
  return {static_cast<double>(code_of(k)), 1.0 / (component(in, k).particles.density * geometry::volume(3, radius))};
}

PairMaterial pair_material(const Input& in, int first, int second) {
  const int a = std::min(first, second), b = std::max(first, second);
  const Component &one = component(in, a), &other = component(in, b);
  const auto mean = [&](double Component::*member) {
    return a == b ? one.*member : std::sqrt(one.*member * other.*member);
  };
  PairMaterial pair{.normal_modulus = 1.0 / (normal_compliance(one.particles) + normal_compliance(other.particles)),
                    .shear_modulus = 1.0 / (shear_compliance(one.particles) + shear_compliance(other.particles)),
                    .damping_ratio = mean(&Component::damping_ratio),
                    .friction = {mean(&Component::friction), 0.0, mean(&Component::rolling_friction),
                                 mean(&Component::twisting_friction)}};
  for (const input::ComponentPair& said : in.pairs) {
    if (std::min(said.first, said.second) != a || std::max(said.first, said.second) != b) continue;
    pair.damping_ratio = said.damping_ratio.value_or(pair.damping_ratio);
    pair.friction.particles = said.friction.value_or(pair.friction.particles);
    pair.friction.rolling = said.rolling_friction.value_or(pair.friction.rolling);
    pair.friction.twisting = said.twisting_friction.value_or(pair.friction.twisting);
  }
  return pair;
}

PairMaterial wall_material(const Input& in, int a) {
  const Component& of = component(in, a);
  const double sharing = in.contact.wall == input::WallStiffness::rigid ? 1.0 : 2.0;
  return {.normal_modulus = 1.0 / (sharing * normal_compliance(of.particles)),
          .shear_modulus = 1.0 / (sharing * shear_compliance(of.particles)),
          .damping_ratio = of.damping_ratio,
          .friction = {of.wall_friction, of.wall_friction, of.rolling_friction, of.twisting_friction}};
}

double densest(const Input& in) {
  double most = in.particles.density;
  for (const Component& of : in.components) most = std::max(most, of.particles.density);
  return most;
}

Particles softest(const Input& in) {
  return most_of(in, [](const Particles& p) { return p.density * normal_compliance(p); });
}

Particles most_compliant(const Input& in) { return most_of(in, normal_compliance); }

Particles limiting(const Input& in) { return in.confinement ? most_compliant(in) : softest(in); }

std::string limiting_key(const Input& in) {
  const Particles of = limiting(in);
  const auto is = [&](const Component& one) {
    return one.particles.youngs_modulus == of.youngs_modulus && one.particles.density == of.density;
  };
  const auto found = std::ranges::find_if(in.components, is);
  return found == in.components.end() ? "particles.youngs_modulus" : "component.youngs_modulus of " + found->name;
}

Recipe recipe_of(const Scene& scene, const std::vector<double>& shares) {
  const bool number = by_number(scene), mass = scene.in.mixture.share_by == "mass";
  const int dimension = scene.container.dimension;
  Recipe recipe;
  double numbers = 0.0, volumes = 0.0, masses = 0.0, extents = 0.0;
  for (std::size_t k = 0; k < shares.size(); ++k) {
    const SizeCurve& curve = scene.component_sizes[k].curve();
    const double density = scene.in.components[k].particles.density;
    const double volume = geometry::volume(3, 1.0) * curve.moment(3);  // of a particle
    const double count = number ? shares[k] : shares[k] / (volume * (mass ? density : 1.0));
    recipe.numbers.push_back(count);
    recipe.volumes.push_back(count * volume);
    numbers += count, volumes += count * volume, masses += count * volume * density;
    extents += count * geometry::volume(dimension, 1.0) * curve.moment(dimension);
  }
  for (double& share : recipe.numbers) share /= numbers;
  for (double& share : recipe.volumes) share /= volumes;
  recipe.mean_volume = volumes / numbers;
  recipe.mean_extent = extents / numbers;
  recipe.density = masses / volumes;
  return recipe;
}

Recipe recipe_of(const Scene& scene, std::size_t stratum) {
  std::vector<double> shares;
  for (const Component& of : scene.in.components) shares.push_back(of.share);
  if (stratum < scene.in.strata.size() && !scene.in.strata[stratum].shares.empty())
    shares = scene.in.strata[stratum].shares;
  return recipe_of(scene, shares);
}

double volume_unit(const Scene& scene) {
  return std::scalbn(1.0, std::ilogb(geometry::volume(3, scene.sizes.largest())) - 32);
}

std::int64_t volume_units(const Scene& scene, double radius) {
  return std::llrint(geometry::volume(3, radius) / volume_unit(scene));
}

std::int64_t units_of(const Scene& scene, double radius) {
  return by_number(scene) ? units_a_particle : volume_units(scene, radius);
}

double radius_of(const Scene& scene, int component, std::uint64_t number) {
  return scene.component_sizes[static_cast<std::size_t>(component)].draw(static_cast<std::uint32_t>(component), number);
}

}  // namespace packmpi::scene
