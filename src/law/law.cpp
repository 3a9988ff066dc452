#include "law/law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "scene/mixture.hpp"

namespace packmpi::dynamics {
namespace {

constexpr double unbounded_slip_rate = 1e150;  // [1/s]; its products with any mass and slip stay finite

/// By the effective modulus E*.
LawConstants constants(double modulus, double damping_ratio, double friction) {
  return {.stiffness = 4.0 / 3.0 * modulus,
          .damping = 2.0 * damping_ratio * std::sqrt(2.0 * modulus),
          .friction = friction,
          .reduced_radius = 0.0,
          .reduced_mass = 0.0};
}

/// E* of two bodies of which `sharing` deform: 2 for a pair of particles, 1 at a rigid wall.
double normal_modulus(const input::Particles& of, double youngs_modulus, double sharing) {
  const double nu = of.poisson_ratio;
  return youngs_modulus / (sharing * (1.0 - nu * nu));
}

/// G* of the same: 1/G* = sharing (2 - nu) / G with G = E / (2 (1 + nu)).
double shear_modulus(const input::Particles& of, double youngs_modulus, double sharing) {
  const double nu = of.poisson_ratio;
  return youngs_modulus / (2.0 * sharing * (1.0 + nu) * (2.0 - nu));
}

/// Mindlin's no-slip stiffness by the effective modulus G*, and the torques' limits.
void add_memory(double modulus, double damping_ratio, double slip_mass, const scene::Friction& friction,
                LawConstants& c) {
  c.shear_stiffness = 8.0 * modulus;
  c.shear_damping = 2.0 * damping_ratio * std::sqrt(c.shear_stiffness * slip_mass);
  c.rolling_friction = friction.rolling;
  c.twisting_friction = friction.twisting;
}

// In how many steps "shared" ends the slip of a contact. All contacts of a particle brake it at once: the spin of one
// that rolls on Z others is braked by Z 10/21 (in the plane Z 5/7) times what one contact aims at, so that at three
// steps six contacts (four in the plane) do not turn a spin round, and the twelve of the densest packing do not let it
// grow (doc/theory.md, "Friction at small slip").
constexpr double steps_shared = 3.0;

/// Each constant at least what it is in `c`.
void raise(LawConstants& most, const LawConstants& c) {
  for (const auto member :
       {&LawConstants::stiffness, &LawConstants::damping, &LawConstants::friction, &LawConstants::shear_stiffness,
        &LawConstants::shear_damping, &LawConstants::rolling_friction, &LawConstants::twisting_friction}) {
    most.*member = std::max(most.*member, c.*member);
  }
}

/// A stage's coefficients for a contact whose own are `of`: sliding is multiplied by what it is of [contact]'s, and so
/// are rolling and twisting where that is less than 1; what the stage adds to those of [contact] it adds here.
scene::Friction staged(const scene::Friction& of, const scene::Friction& stage, const scene::Friction& own) {
  const double share = own.particles > 0.0 ? stage.particles / own.particles : 1.0;
  const double less = std::min(1.0, share);
  return {share * of.particles, share * of.walls, less * of.rolling + (stage.rolling - less * own.rolling),
          less * of.twisting + (stage.twisting - less * own.twisting)};
}

/// The tables of several components, and their largest constants. `softer`: the stage's modulus over the scene's.
void add_mixture(const scene::Scene& scene, double softer, const scene::Friction& stage, Law& law) {
  const input::Input& in = scene.in;
  const scene::Friction own = scene::own_friction(in.contact);
  const auto count = static_cast<int>(in.components.size());
  auto tables = std::make_shared<std::vector<LawConstants>>(
      static_cast<std::size_t>(scene::pair_codes + scene::wall_codes), law.pair);
  const auto made = [&](const scene::PairMaterial& of, double scene::Friction::*slides) {
    const scene::Friction friction = staged(of.friction, stage, own);
    LawConstants c = constants(softer * of.normal_modulus, of.damping_ratio, friction.*slides);
    if (scene.features.memory) add_memory(softer * of.shear_modulus, of.damping_ratio, law.slip_mass, friction, c);
    return c;
  };
  const auto pair = [&](int a, int b) { return made(scene::pair_material(in, a, b), &scene::Friction::particles); };
  law.pair = law.wall = pair(0, 0);
  for (int a = 0; a < count; ++a) {
    for (int b = 0; b < count; ++b) {
      const int code = scene::code_of(a) + scene::code_of(b);
      raise(law.pair, tables->at(static_cast<std::size_t>(code)) = pair(a, b));
    }
    const int code = scene::pair_codes + scene::code_of(a);
    raise(law.wall,
          tables->at(static_cast<std::size_t>(code)) = made(scene::wall_material(in, a), &scene::Friction::walls));
  }
  law.pair_table = tables->data();
  law.wall_table = tables->data() + scene::pair_codes;
  law.tables = std::move(tables);
}

double slip_rate(const input::Contact& contact, double time_step) {
  switch (contact.regularisation) {
    case input::Regularisation::stop:
      return 1.0 / time_step;
    case input::Regularisation::shared:
      return 1.0 / (steps_shared * time_step);
    case input::Regularisation::viscous:
      return 1.0 / contact.slip_time;
    case input::Regularisation::none:
      break;
  }
  return unbounded_slip_rate;
}

}  // namespace

Law make_law(const scene::Scene& scene, const scene::Stage& stage) {
  const input::Input& in = scene.in;
  const scene::Friction friction = stage.friction.value_or(scene::own_friction(in.contact));
  const bool rigid = in.contact.wall == input::WallStiffness::rigid;
  const bool rolls = scene.features.rotation &&
                     in.contact.friction_velocity == input::FrictionVelocity::contact;  // spin takes up slip
  const double wall_sharing = rigid ? 1.0 : 2.0;
  const double modulus = stage.youngs_modulus, damping = in.contact.damping_ratio;
  Law law{.pair = constants(normal_modulus(in.particles, modulus, 2.0), damping, friction.particles),
          .wall = constants(normal_modulus(in.particles, modulus, wall_sharing), damping, friction.walls),
          .mass_factor = 3.0 / (4.0 * std::numbers::pi * in.particles.density),
          .spin_slip = in.contact.friction_velocity == input::FrictionVelocity::contact ? 1.0 : 0.0,
          .slip_rate = slip_rate(in.contact, stage.time_step),
          .slip_mass = rolls ? 2.0 / 7.0 : 1.0,
          .lowest_force = in.contact.tension_cutoff ? 0.0 : -std::numeric_limits<double>::infinity()};
  if (scene.features.memory) {
    add_memory(shear_modulus(in.particles, modulus, 2.0), damping, law.slip_mass, friction, law.pair);
    add_memory(shear_modulus(in.particles, modulus, wall_sharing), damping, law.slip_mass, friction, law.wall);
  }
  if (scene.features.mixture) add_mixture(scene, modulus / in.particles.youngs_modulus, friction, law);
  if (scene.sizes.equal()) {
    const double k = 1.0 / scene.sizes.largest();
    law.wall.reduced_radius = scene.sizes.largest();
    law.wall.reduced_mass = 1.0 / (law.mass_factor * k * k * k);
    law.pair.reduced_radius = 0.5 * law.wall.reduced_radius;
    law.pair.reduced_mass = 0.5 * law.wall.reduced_mass;
  }
  return law;
}

}  // namespace packmpi::dynamics
