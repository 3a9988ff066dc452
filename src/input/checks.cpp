#include "input/checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "input/rhythm.hpp"
#include "input/words.hpp"

namespace packmpi::input {
namespace {

/// The scene under check, and a few lengths every check asks for.
struct Case {
  const Input& in;
  const Document& document;

  [[noreturn]] void refuse(std::string_view path, const std::string& words) const {
    fail(document.place(path), path, words);
  }
  [[nodiscard]] const Radius& radius() const { return in.particles.radius; }
  [[nodiscard]] bool equal() const { return radius().distribution == SizeDistribution::equal; }
  [[nodiscard]] bool plane() const { return in.container.dimension == 2; }
  [[nodiscard]] double smallest() const { return equal() ? radius().value : radius().min; }
  [[nodiscard]] double largest() const { return equal() ? radius().value : radius().max; }
  [[nodiscard]] const char* largest_key() const { return equal() ? "particles.radius.value" : "particles.radius.max"; }
  [[nodiscard]] double height() const { return in.container.size.back(); }
  /// How many particles of radius r fill the solid fraction `fraction` of a box `high` [m] on the container's floor.
  /// A product of ratios, so that no power of a length under- or overflows on its own.
  [[nodiscard]] double particles_in(double high, double fraction, double r) const {
    double count = fraction * (high / r) / (plane() ? std::numbers::pi : 4.0 / 3.0 * std::numbers::pi);
    for (int axis = 0; axis + 1 < in.container.dimension; ++axis) {
      count *= in.container.size[static_cast<std::size_t>(axis)] / r;
    }
    return count;
  }
};

/// The share of a Gaussian's draws that fall into [min, max].
double kept_share(const Radius& radius) {
  const double scale = radius.sd * std::numbers::sqrt2;
  return 0.5 * (std::erf((radius.max - radius.mean) / scale) - std::erf((radius.min - radius.mean) / scale));
}

void check_radii(const Case& scene) {
  const Radius& radius = scene.radius();
  if (scene.equal()) return;
  if (radius.min >= radius.max) {
    scene.refuse("particles.radius.min",
                 fmt::format("{:g} m is not below max = {:g} m; exchange them, or use distribution = \"equal\"",
                             radius.min, radius.max));
  }
  if (radius.distribution != SizeDistribution::gaussian) return;
  if (radius.mean < radius.min || radius.mean > radius.max) {
    scene.refuse("particles.radius.mean",
                 fmt::format("{:g} m is outside min = {:g} m and max = {:g} m; move one of them", radius.mean,
                             radius.min, radius.max));
  }
  constexpr double least_share = 0.01;  // rejection redraws stay below a hundred on average
  if (kept_share(radius) < least_share) {
    scene.refuse(
        "particles.radius.sd",
        fmt::format("less than {:g} % of the draws fall between min = {:g} m and max = {:g} m; widen them, or use "
                    "distribution = \"uniform\"",
                    100.0 * least_share, radius.min, radius.max));
  }
}

void check_fit(const Case& scene) {
  const double diameter = 2.0 * scene.largest();
  const auto& size = scene.in.container.size;
  for (std::size_t axis = 0; axis < size.size(); ++axis) {
    if (diameter <= size[axis]) continue;
    scene.refuse(scene.largest_key(),
                 fmt::format("the largest particle is {:g} m across, more than container.size[{}] = {:g} m; "
                             "make it smaller or the container larger",
                             diameter, axis, size[axis]));
  }
  if (diameter > scene.in.layers.thickness) {
    scene.refuse("layers.thickness",
                 fmt::format("{:g} m is less than the largest particle, {:g} m across; make layers thicker",
                             scene.in.layers.thickness, diameter));
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
  const double graded_limit = large ? 1.25 * saturation : densest;
  const double overshoot = 1.0 / scene.particles_in(layers.thickness, 1.0, scene.largest());
  if (layers.fraction > graded_limit + overshoot) {
    scene.refuse("layers.fraction", fmt::format("{:g} cannot be reached by random insertion; lower it ({} is usual)",
                                                layers.fraction, scene.plane() ? "0.4" : "0.25"));
  }
}

void check_counts(const Case& scene) {
  constexpr double most_particles = 0x1p40, most_layers = 0x1p24;
  const Layers& layers = scene.in.layers;
  const double settled = scene.plane() ? 0.85 : 0.6;
  const double typical = scene.radius().distribution == SizeDistribution::gaussian
                             ? scene.radius().mean
                             : 0.5 * (scene.smallest() + scene.largest());
  const double count = scene.particles_in(scene.height(), settled, typical);
  if (!(count <= most_particles)) {
    scene.refuse("container.size",
                 fmt::format("about {:.2g} particles, more than 2^40; make the container smaller or the "
                             "particles larger",
                             count));
  }
  const double layer_count = settled / layers.fraction * (scene.height() / layers.thickness);
  if (!(layer_count <= most_layers)) {
    scene.refuse("layers.fraction",
                 fmt::format("about {:.2g} layers, more than 2^24; insert thicker or denser layers", layer_count));
  }
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

void check_time(const Case& scene) {
  const Input& in = scene.in;
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
  const auto thaw = scene.in.dynamics.thaw;
  if (!thaw) return;
  if (*thaw == 0.0 && modulus < scene.in.particles.youngs_modulus) {
    scene.refuse("dynamics.thaw", "softer layers harden in it; give a time, or remove layers.youngs_modulus");
  }
  if (*thaw > 0.0) check_step(scene, "dynamics.time_step", scene.in.dynamics.time_step, "dynamics.thaw", *thaw);
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

void check_theta(const Case& scene) {
  const double theta = scene.in.dynamics.theta;
  if (theta == 0.0) return;
  if (theta < 0.5) {
    scene.refuse("dynamics.theta", fmt::format("{:g} is neither explicit nor stable; give 0, or 0.5 to 1", theta));
  }
  if (scene.in.contact.regularisation == Regularisation::none) {
    scene.refuse("contact.regularisation",
                 "friction that jumps with the slip has no derivative for the implicit scheme; use \"stop\" or "
                 "\"viscous\", or dynamics.theta = 0");
  }
}

void check_checkpoint(const Case& scene) {
  const std::string& every = scene.in.checkpoint.every;
  if (rhythm_of(every)) return;
  scene.refuse("checkpoint.every",
               fmt::format("is {}; give a wall time such as \"10min\", \"90 s\" or \"2h\", steps such as "
                           "\"5000 steps\", or \"off\"",
                           toml_string(every)));
}

}  // namespace

void check(const Input& in, const Document& document) {
  const Case scene{in, document};
  check_radii(scene);
  check_fit(scene);
  check_fraction(scene);
  check_counts(scene);
  check_time(scene);
  check_stages(scene);
  check_features(scene);
  check_theta(scene);
  check_checkpoint(scene);
}

}  // namespace packmpi::input
