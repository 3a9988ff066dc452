#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "base/elementary.hpp"
#include "checks/checks.hpp"
#include "checks/scene_case.hpp"
#include "comm/petsc.hpp"
#include "config/grading.hpp"
#include "config/time_step.hpp"
#include "tables/rhythm.hpp"

namespace packmpi::input {

using document::fail;
using tables::toml_string;

namespace {

/// The share of a Gaussian, lognormal or Weibull distribution that falls into [min, max].
double kept_share(const Radius& radius) {
  const auto normal = [](double x) { return 0.5 * elementary::complementary_error(-x / std::numbers::sqrt2); };
  const auto below = [&](double r) {
    if (radius.distribution == SizeDistribution::gaussian) return normal((r - radius.mean) / radius.sd);
    if (radius.distribution == SizeDistribution::lognormal)
      return normal(elementary::logarithm(r / radius.median) / radius.log_sd);
    return 1.0 - elementary::exponential(-elementary::power(r / radius.scale, radius.shape));
  };
  return below(radius.max) - below(radius.min);
}

void check_truncation(const Case& scene) {
  const Radius& radius = scene.radius();
  if (radius.min >= radius.max) {
    scene.refuse("particles.radius.min",
                 fmt::format("{:g} m is not below max = {:g} m; exchange them, or use distribution = \"equal\"",
                             radius.min, radius.max));
  }
  if (radius.distribution == SizeDistribution::uniform) return;
  const bool gaussian = radius.distribution == SizeDistribution::gaussian;
  if (gaussian && (radius.mean < radius.min || radius.mean > radius.max)) {
    scene.refuse("particles.radius.mean",
                 fmt::format("{:g} m is outside min = {:g} m and max = {:g} m; move one of them", radius.mean,
                             radius.min, radius.max));
  }
  constexpr double least_share = 0.01;  // rejection redraws stay below a hundred on average
  if (kept_share(radius) < least_share) {
    scene.refuse(gaussian                                             ? "particles.radius.sd"
                 : radius.distribution == SizeDistribution::lognormal ? "particles.radius.log_sd"
                                                                      : "particles.radius.shape",
                 fmt::format("less than {:g} % of the {} fall between min = {:g} m and max = {:g} m; widen them, or "
                             "use distribution = \"uniform\"",
                             100.0 * least_share, gaussian ? "draws" : "distribution", radius.min, radius.max));
  }
}

void check_classes(const Case& scene) {
  const Radius& radius = scene.radius();
  if (radius.radii.empty()) scene.refuse("particles.radius.radii", "is empty; give a radius at least");
  if (radius.shares.size() != radius.radii.size()) {
    scene.refuse("particles.radius.shares",
                 fmt::format("{} shares for {} radii; give one for each", radius.shares.size(), radius.radii.size()));
  }
  for (std::size_t k = 1; k < radius.radii.size(); ++k) {
    if (radius.radii[k - 1] < radius.radii[k]) continue;
    scene.refuse("particles.radius.radii",
                 fmt::format("{:g} m follows {:g} m; radii must ascend", radius.radii[k], radius.radii[k - 1]));
  }
}

void check_grading(const Case& scene) {
  const Radius& radius = scene.radius();
  if (radius.diameter_curve.empty()) {
    scene.refuse("particles.radius.diameter_curve",
                 "is missing; give points [diameter, percent passing], or diameter_curve_file");
  }
  if (radius.keep_percent[0] >= radius.keep_percent[1]) {
    scene.refuse("particles.radius.keep_percent",
                 fmt::format("{:g} is not below {:g}; exchange them", radius.keep_percent[0], radius.keep_percent[1]));
  }
  if (const std::string words = flaw(radius.diameter_curve, radius.keep_percent); !words.empty()) {
    scene.refuse("particles.radius.diameter_curve", words);
  }
}

void check_distribution(const Case& scene) {
  const Radius& radius = scene.radius();
  switch (radius.distribution) {
    case SizeDistribution::equal:
      return;
    case SizeDistribution::bidisperse:
      if (radius.small < radius.large) return;
      scene.refuse("particles.radius.small",
                   fmt::format("{:g} m is not below large = {:g} m; exchange them, or use distribution = \"equal\"",
                               radius.small, radius.large));
    case SizeDistribution::discrete:
      return check_classes(scene);
    case SizeDistribution::list:
      if (!radius.radii.empty()) return;
      scene.refuse("particles.radius.radii", "is missing; give the radii one by one, or list_file");
    case SizeDistribution::grading:
      return check_grading(scene);
    default:
      return check_truncation(scene);
  }
}

/// Random insertion saturates. The limits are those of large regions of equal spheres, so small or graded regions are
/// held to weaker ones that are certain.
void check_fraction(const Case& scene) {
  const Layers& layers = scene.in.layers;
  const double saturation = scene.plane() ? 0.547 : 0.384;
  const double densest = scene.plane() ? 0.9069 : 0.7405;
  const bool large =
      scene.particles_in(layers.thickness, 1.0, scene.largest()) > 1000.0 && layers.thickness > 4.0 * scene.largest();
  if (scene.equal() && large && layers.fraction > saturation) {
    scene.refuse(
        "layers.fraction",
        fmt::format("{:g} is beyond {:g}, where random insertion of equal {} ends; lower it ({} is usual)",
                    layers.fraction, saturation, scene.plane() ? "discs" : "spheres", scene.plane() ? "0.4" : "0.25"));
  }
  // The last particle may overshoot: n - 1 of them must hold less than phi_0, n can be the densest packing at most.
  const bool narrow = scene.largest() <= 2.0 * scene.smallest();  // no room for small ones between large ones
  const double graded_limit = large && narrow ? 1.25 * saturation : densest;
  const double overshoot = 1.0 / scene.particles_in(layers.thickness, 1.0, scene.largest());
  if (layers.fraction > graded_limit + overshoot) {
    scene.refuse("layers.fraction", fmt::format("{:g} cannot be reached by random insertion; lower it ({} is usual)",
                                                layers.fraction, scene.plane() ? "0.4" : "0.25"));
  }
}

void check_counts(const Case& scene) {
  constexpr double most_particles = 0x1p40, most_layers = 0x1p24;
  const Layers& layers = scene.in.layers;
  if (insertion_alone(scene.in) || scene.in.particles.count > 0) return;
  const double settled = scene.plane() ? 0.85 : 0.6;
  const Radius& radius = scene.radius();
  const bool by_number = radius.weighting == Weighting::number;
  double typical = scene.largest();  // of the others, that many at least; scene::build knows more
  if (by_number && radius.distribution == SizeDistribution::gaussian) typical = radius.mean;
  if (by_number && radius.distribution == SizeDistribution::uniform) typical = 0.5 * (radius.min + radius.max);
  const double most = layers.maximum > 0 ? static_cast<double>(layers.maximum) : HUGE_VAL;  // layers
  const double count = std::min(scene.particles_in(scene.height(), settled, typical),
                                most * scene.particles_in(layers.thickness, layers.fraction, typical));
  if (!(count <= most_particles)) {
    scene.refuse(scene.extent_key(),
                 fmt::format("about {:.2g} particles, more than 2^40; make the container smaller or the "
                             "particles larger",
                             count));
  }
  const double layer_count = std::min(most, settled / layers.fraction * (scene.height() / layers.thickness));
  if (!(layer_count <= most_layers)) {
    scene.refuse("layers.fraction",
                 fmt::format("about {:.2g} layers, more than 2^24; insert thicker or denser layers", layer_count));
  }
}

/// Overlaps are differences of positions.
void check_resolution(const Case& scene) {
  constexpr double widest = 1e9;  // there two neighbouring doubles are 1e-7 radii apart
  const auto check = [&](const char* key, double length) {
    if (length <= widest * scene.smallest()) return;
    scene.refuse(key, fmt::format("{:g} m is {:.2g} times the smallest radius; beyond {:g} positions could not tell "
                                  "overlaps; make it smaller or the particles larger",
                                  length, length / scene.smallest(), widest));
  };
  for (const double length : scene.in.container.size) check(scene.extent_key(), length);
  check("layers.thickness", scene.in.layers.thickness);
}

/// One of the two time steps against what it must fit into.
void check_step(const Case& scene, const char* key, std::optional<double> step, const char* whole_key, double whole) {
  if (!step) return;
  if (*step > whole) {
    scene.refuse(key, fmt::format("{:g} s is longer than {} = {:g} s; shorten it", *step, whole_key, whole));
  }
  if (!(whole / *step <= 0x1p40)) {
    scene.refuse(key, fmt::format("{:.2g} steps a layer, more than 2^40; lengthen it", whole / *step));
  }
  if (scene.in.contact.regularisation == Regularisation::viscous && *step > 0.5 * scene.in.contact.slip_time) {
    scene.refuse("contact.slip_time",
                 fmt::format("{:g} s is shorter than two time steps of {:g} s; lengthen it, or shorten the step",
                             scene.in.contact.slip_time, *step));
  }
}

/// Nothing moves: what asks for motion is a mistake.
void check_insertion_alone(const Case& scene) {
  const Input& in = scene.in;
  if (!insertion_alone(in)) return;
  if (in.dynamics.relaxation.value_or(0.0) > 0.0) {
    scene.refuse("dynamics.relaxation", "layers.duration = 0 is insertion alone, without a final stage; remove one");
  }
  if (in.start) {
    scene.refuse("start", "layers.duration = 0 is insertion alone, into an empty container; remove one of them");
  }
}

void check_time(const Case& scene) {
  const Input& in = scene.in;
  if (insertion_alone(in)) return;
  check_step(scene, "dynamics.time_step", in.dynamics.time_step, "layers.duration", in.layers.duration);
  check_step(scene, "layers.time_step", in.layers.time_step, "layers.duration", in.layers.duration);
}

void check_stages(const Case& scene) {
  const Layers& layers = scene.in.layers;
  const double modulus = layers.youngs_modulus.value_or(scene.in.particles.youngs_modulus);
  if (modulus > scene.in.particles.youngs_modulus) {
    scene.refuse("layers.youngs_modulus",
                 fmt::format("{:g} Pa is above particles.youngs_modulus = {:g} Pa; layers settle softer or alike",
                             modulus, scene.in.particles.youngs_modulus));
  }
  const auto relaxation = scene.in.dynamics.relaxation;
  if (!relaxation) return;
  if (*relaxation == 0.0 && modulus < scene.in.particles.youngs_modulus) {
    scene.refuse("dynamics.relaxation", "softer layers harden in it; give a time, or remove layers.youngs_modulus");
  }
  if (*relaxation > 0.0)
    check_step(scene, "dynamics.time_step", scene.in.dynamics.time_step, "dynamics.relaxation", *relaxation);
}

void check_features(const Case& scene) {
  const Input& in = scene.in;
  if (!in.dynamics.rotation && in.layers.spin != Vec3{}) {
    scene.refuse("layers.spin", "particles without rotation cannot spin; remove it, or set dynamics.rotation = true");
  }
  if (in.near_field && in.near_field->cutoff <= 2.0 * scene.smallest()) {
    scene.refuse("near_field.cutoff",
                 fmt::format("{:g} m is not beyond the contact distance {:g} m of the smallest particles; lengthen it",
                             in.near_field->cutoff, 2.0 * scene.smallest()));
  }
}

void check_memory(const Case& scene) {
  const Input& in = scene.in;
  const bool rolling = in.contact.rolling_friction > 0.0;
  const bool twisting = in.contact.twisting_friction > 0.0;
  if (twisting && in.container.dimension == 2) {
    scene.refuse("contact.twisting_friction", "discs spin in their plane and never about a normal; remove it");
  }
  if ((rolling || twisting) && !in.dynamics.rotation) {
    scene.refuse(rolling ? "contact.rolling_friction" : "contact.twisting_friction",
                 "particles without rotation cannot roll; remove it, or set dynamics.rotation = true");
  }
  const bool rough = in.contact.friction > 0.0 || in.contact.wall_friction > 0.0;
  if ((rolling || twisting) && !rough) {
    scene.refuse("contact.friction", "resistance to rolling wants friction, too; give it, or remove the resistance");
  }
}

void check_theta(const Case& scene) {
  const double theta = scene.in.dynamics.theta;
  if (theta == 0.0) return;
  if (theta < 0.5) {
    scene.refuse("dynamics.theta", fmt::format("{:g} is neither explicit nor stable; give 0, or 0.5 to 1", theta));
  }
  if (scene.in.contact.tangential == Tangential::mindlin) {
    scene.refuse("contact.tangential",
                 "implicit steps have no friction with memory; use \"sliding\", or dynamics.theta = 0");
  }
  if (scene.in.contact.regularisation == Regularisation::none) {
    scene.refuse("contact.regularisation",
                 "friction that jumps with the slip has no derivative for the implicit scheme; use \"shared\" or "
                 "\"viscous\", or dynamics.theta = 0");
  }
}

void check_target(const Case& scene) {
  const Input& in = scene.in;
  if (!in.target) return;
  const Target& target = *in.target;
  const int ways = (target.solid_fraction ? 1 : 0) + (target.porosity ? 1 : 0) + (target.void_ratio ? 1 : 0) +
                   (target.relative_density ? 1 : 0);
  const auto words = fmt::format("has {} of solid_fraction, porosity, void_ratio and relative_density; give one", ways);
  if (ways != 1) scene.refuse("target", words);
  if (insertion_alone(in))
    scene.refuse("target",
                 "layers.duration = 0 is insertion alone, whose density is layers.fraction; remove one of them");
  if (in.start)
    scene.refuse("target", "how the layers of start.pack were filled in is not known; remove [target] or [start]");
  if (target.state == TargetState::confined && !in.confinement) {
    scene.refuse("target.state",
                 "\"confined\" is a density under the stress of [confinement], which is not there; add it");
  }
  if (in.contact.tangential == Tangential::sliding) {
    scene.refuse("contact.tangential",
                 "\"sliding\" friction has no memory, and density hardly depends on it; use \"mindlin\" with a target "
                 "(fidelity = \"paper\" sets \"sliding\" unless the scene says so)");
  }
  if (!(in.contact.friction > 0.0))
    scene.refuse("contact.friction",
                 "a target is met by friction in proportion to this, and it is 0; give some, or remove [target]");
  if (!in.components.empty() && !components_have_friction(in))
    scene.refuse("target", "is met by friction, which no component has; give some, or remove [target]");
  if (target.most_friction <= least_filling_friction) {
    scene.refuse("target.most_friction",
                 fmt::format("{:g} is not above {:g}, the least that layers are filled in with; raise it",
                             target.most_friction, least_filling_friction));
  }
  if (target.most_rolling_friction < in.contact.rolling_friction) {
    scene.refuse("target.most_rolling_friction",
                 fmt::format("{:g} is less than contact.rolling_friction = {:g}; raise it, or leave it out",
                             target.most_rolling_friction, in.contact.rolling_friction));
  }
  if (target.most_rolling_friction > 0.0 && !in.dynamics.rotation) {
    scene.refuse("target.most_rolling_friction", "particles without rotation cannot roll; remove it");
  }
}

void check_confinement(const Case& scene) {
  const Input& in = scene.in;
  if (!in.confinement) return;
  const Confinement& asked = *in.confinement;
  if (!scene.boxed() && asked.on_sides()) {
    scene.refuse(asked.isotropic ? "confinement.isotropic" : "confinement.lateral",
                 "the sides of this vessel do not move, those of a box do; give vertical alone, or shape = \"box\"");
  }
  if (asked.isotropic.has_value() == asked.vertical.has_value()) {
    scene.refuse("confinement", asked.isotropic ? "has isotropic and vertical; give one of them"
                                                : "gives no stress; give vertical, vertical and lateral, or isotropic");
  }
  if (asked.isotropic && asked.lateral) {
    scene.refuse("confinement.lateral", "isotropic says what it is; remove it, or give vertical and lateral");
  }
  if (insertion_alone(in)) {
    scene.refuse("confinement", "layers.duration = 0 is insertion alone: no particle touches another; remove one");
  }
  if (in.dynamics.theta > 0.0) {
    scene.refuse("confinement", "a lid wants explicit steps; use dynamics.theta = 0, or remove it");
  }
  if (has_friction(in) && in.contact.tangential == Tangential::sliding) {
    scene.refuse("contact.tangential",
                 "\"sliding\" friction has no memory: under stress a pack creeps for ever; use \"mindlin\" with "
                 "[confinement] (fidelity = \"paper\" sets \"sliding\" unless the scene says so)");
  }
}

void check_checkpoint(const Case& scene) {
  const std::string& every = scene.in.checkpoint.every;
  if (tables::rhythm_of(every)) return;
  scene.refuse("checkpoint.every",
               fmt::format("is {}; give a wall time such as \"10min\", \"90 s\" or \"2h\", steps such as "
                           "\"5000 steps\", or \"off\"",
                           toml_string(every)));
}

void check_petsc(const Case& scene) {
  const std::string flaw = comm::petsc_options_flaw(scene.in.petsc.options);
  if (!flaw.empty()) scene.refuse("petsc.options", flaw);
}

}  // namespace

void check_radii(const Input& in, const Document& document) { check_distribution({in, document}); }

void check(const Input& in, const Document& document) {
  const Case scene{in, document};
  check_vessel(scene);
  check_fraction(scene);
  check_counts(scene);
  check_resolution(scene);
  check_insertion_alone(scene);
  check_time(scene);
  check_stages(scene);
  check_features(scene);
  check_memory(scene);
  check_theta(scene);
  check_target(scene);
  check_confinement(scene);
  check_checkpoint(scene);
  check_petsc(scene);
}

}  // namespace packmpi::input
