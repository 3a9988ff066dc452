#include "exporters/law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/elementary.hpp"

namespace packmpi::exporters {
namespace {

double tsuji(double e) {
  return 1.2728 + e * (-4.2783 + e * (11.087 + e * (-22.348 + e * (27.467 + e * (-18.022 + e * 4.8218)))));
}

}  // namespace

double tsuji_restitution(double damping_ratio) {
  const double wanted = std::sqrt(6.0) * damping_ratio;
  double low = -2.0;  // falls all the way from here to ...
  double high = 1.1;  // ... below zero
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (tsuji(middle) > wanted ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

double restitution(double damping_ratio) {
  const double beta = std::sqrt(1.2) * damping_ratio;
  return beta < 1.0 ? elementary::exponential(-std::numbers::pi * beta / std::sqrt(1.0 - beta * beta)) : 0.0;
}

double shear_modulus(const Specimen& specimen) {
  const input::Particles& p = specimen.scene.in.particles;
  return p.youngs_modulus / (2.0 * (1.0 + p.poisson_ratio));
}

bool remembers(const Specimen& specimen) { return specimen.scene.in.contact.tangential == input::Tangential::mindlin; }

double step_of_stronger_dashpot(const Specimen& specimen) {
  const input::Input& in = specimen.scene.in;
  double ratio = in.contact.damping_ratio;
  for (const input::Component& of : in.components) ratio = std::max(ratio, of.damping_ratio);
  const auto limit = [](double zeta) { return std::sqrt(zeta * zeta + 1.0) - zeta; };
  const bool turns = remembers(specimen) && specimen.rotation;
  return specimen.step() * (turns ? limit(std::sqrt(3.5) * ratio) / limit(ratio) : 1.0);
}

std::vector<std::string> left_out(const Specimen& specimen, Fluid fluid, Rolling rolling) {
  const input::Input& in = specimen.scene.in;
  std::vector<std::string> lines;
  if (specimen.scene.features.near_field) lines.emplace_back("the near-field force of the scene");
  if (in.drag.coefficient > 0.0) {
    const Vec3& u = in.drag.fluid_velocity;
    const bool moves = u[0] != 0.0 || u[1] != 0.0 || u[2] != 0.0;
    if (fluid == Fluid::not_carried) lines.emplace_back("the drag of the scene");
    if (fluid == Fluid::at_rest && moves) lines.emplace_back("the velocity of the scene's fluid");
  }
  const bool resists = in.contact.rolling_friction > 0.0 || in.contact.twisting_friction > 0.0;
  if (resists && rolling == Rolling::not_carried) lines.emplace_back("the resistance to rolling and twisting");
  const bool slides = in.contact.friction > 0.0 || in.contact.wall_friction > 0.0;
  if (specimen.rotation && slides && in.contact.friction_velocity == input::FrictionVelocity::centre) {
    lines.emplace_back("friction by the velocities of centres: here it is that of the contact point");
  }
  return lines;
}

std::string notes(const Specimen& specimen, Fluid fluid, std::string_view mark, Rolling rolling) {
  std::string text = header(specimen, mark);
  for (const std::string& line : left_out(specimen, fluid, rolling))
    text += fmt::format("{}not carried over: {}\n", mark, line);
  return text;
}

}  // namespace packmpi::exporters
