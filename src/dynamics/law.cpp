#include "dynamics/law.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace packmpi::dynamics {
namespace {

constexpr double unbounded_slip_rate = 1e150;  // [1/s]; its products with any mass and slip stay finite

/// Contact of two bodies of which `sharing` deform: 2 for a pair of particles, 1 at a rigid wall.
LawConstants constants(const input::Input& in, double youngs_modulus, double sharing, double friction) {
  const double nu = in.particles.poisson_ratio;
  const double modulus = youngs_modulus / (sharing * (1.0 - nu * nu));  // E*
  return {.stiffness = 4.0 / 3.0 * modulus,
          .damping = 2.0 * in.contact.damping_ratio * std::sqrt(2.0 * modulus),
          .friction = friction,
          .reduced_radius = 0.0,
          .reduced_mass = 0.0};
}

/// Mindlin's no-slip stiffness, 1/G* = sharing (2 - nu) / G with G = E / (2 (1 + nu)), and the torques' limits.
void add_memory(const input::Input& in, double youngs_modulus, double sharing, double slip_mass,
                const scene::Friction& friction, LawConstants& c) {
  const double nu = in.particles.poisson_ratio;
  const double modulus = youngs_modulus / (2.0 * sharing * (1.0 + nu) * (2.0 - nu));  // G*
  c.shear_stiffness = 8.0 * modulus;
  c.shear_damping = 2.0 * in.contact.damping_ratio * std::sqrt(c.shear_stiffness * slip_mass);
  c.rolling_friction = friction.rolling;
  c.twisting_friction = friction.twisting;
}

// In how many steps "shared" ends the slip of a contact. All contacts of a particle brake it at once: the spin of one
// that rolls on Z others is braked by Z 10/21 (in the plane Z 5/7) times what one contact aims at, so that at three
// steps six contacts (four in the plane) do not turn a spin round, and the twelve of the densest packing do not let it
// grow (doc/theory.md, "Friction at small slip").
constexpr double steps_shared = 3.0;

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
  Law law{.pair = constants(in, stage.youngs_modulus, 2.0, friction.particles),
          .wall = constants(in, stage.youngs_modulus, rigid ? 1.0 : 2.0, friction.walls),
          .mass_factor = 3.0 / (4.0 * std::numbers::pi * in.particles.density),
          .spin_slip = in.contact.friction_velocity == input::FrictionVelocity::contact ? 1.0 : 0.0,
          .slip_rate = slip_rate(in.contact, stage.time_step),
          .slip_mass = rolls ? 2.0 / 7.0 : 1.0,
          .lowest_force = in.contact.tension_cutoff ? 0.0 : -std::numeric_limits<double>::infinity()};
  if (scene.features.memory) {
    add_memory(in, stage.youngs_modulus, 2.0, law.slip_mass, friction, law.pair);
    add_memory(in, stage.youngs_modulus, rigid ? 1.0 : 2.0, law.slip_mass, friction, law.wall);
  }
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
