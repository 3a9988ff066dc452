#include "report/judge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/voids.hpp"
#include "config/strata.hpp"
#include "input/time_step.hpp"
#include "scene/expectation.hpp"
#include "scene/mixture.hpp"

namespace packmpi::report {
namespace {

constexpr double deepest = 0.5;  // of a radius: no valid pack has such overlaps

// [s] until what a layer inserts highest has come down to the layer's floor.
double time_of_fall(const input::Input& in) {
  const double g = in.jamming.gravity;
  const double up = in.layers.velocity[static_cast<std::size_t>(in.container.dimension - 1)];
  return g > 0.0 ? (up + std::sqrt(up * up + 2.0 * g * in.layers.thickness)) / g : 0.0;
}

// Why a bed moves on, and what to change: the first of these that is so. `confined`: for so long under its stress [s].
std::string why_it_moves(const scene::Scene& scene, double confined) {
  const input::Input& in = scene.in;
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  const double lift = in.drag.coefficient * in.drag.fluid_velocity[vertical];
  const double weight = input::mass(in.particles, scene.sizes.smallest()) * in.jamming.gravity;
  if (lift > 0.0 && lift >= weight) {
    return fmt::format(
        "the fluid lifts particles by up to {:.3g} N, which weigh {:.3g} N: lower drag.fluid_velocity or "
        "drag.coefficient",
        lift, weight);
  }
  const double fall = time_of_fall(in);
  if (fall > in.layers.duration) {
    const bool thrown = in.layers.velocity[vertical] > 0.0;
    return fmt::format("{} {:.3g} s to come down, layers.duration is {:.3g} s: {}give a duration of {:.2g} s or more",
                       thrown ? "particles are thrown upward by layers.velocity and take" : "a layer takes", fall,
                       in.layers.duration, thrown ? "turn the velocity downward, or " : "", 2.5 * fall);
  }
  const bool slides = in.contact.tangential == input::Tangential::sliding;
  const bool rough = in.contact.friction > 0.0 || in.contact.wall_friction > 0.0;
  const auto law = in.contact.regularisation;
  if (slides && rough && (law == input::Regularisation::stop || law == input::Regularisation::none)) {
    return fmt::format(
        "friction {:g} with contact.regularisation = \"{}\" gives a bed energy at every step: use "
        "\"shared\", or contact.tangential = \"mindlin\"",
        std::max(in.contact.friction, in.contact.wall_friction), law == input::Regularisation::stop ? "stop" : "none");
  }
  const std::string wait = confined > 0.0 ? fmt::format("confinement.wait (now {:.3g} s)", confined)
                                          : fmt::format("rest.wait (now {:.3g} s), layers.duration ({:.3g} s)",
                                                        scene.wait, in.layers.duration);
  return fmt::format("it needs more time or more damping: raise {} or contact.damping_ratio ({:.3g})", wait,
                     in.contact.damping_ratio);
}

// Overlaps go with E^(-2/3).
std::string how_much_harder(const scene::Scene& scene, double overlap, double limit) {
  const double modulus = scene::limiting(scene.in).youngs_modulus * (overlap / limit) * std::sqrt(overlap / limit);
  return fmt::format("particles are too soft for their {}: use {} = {:.1e} Pa or more",
                     scene.in.confinement ? "stress" : "weight", scene::limiting_key(scene.in), 1.1 * modulus);
}

std::string words_of_limit(const Criterion& c) {
  if (c.target == 0.0) return fmt::format("the limit is {:g}", c.limit);
  return fmt::format("it is to be {:g} within {:g}", c.target, c.limit);
}

void add_rest(const scene::Scene& scene, const RunRecord& record, std::vector<std::string>& missed) {
  const bool rests = at_rest(record.criteria);
  for (const Criterion& c : record.criteria) {
    if (c.met()) continue;
    const bool overlap = c.of_overlap;
    const bool soft = overlap && (rests || scene::expected_overlap(scene, scene.in.particles.youngs_modulus) > c.limit);
    missed.push_back(
        fmt::format("rest.{}: the {} is {:.3g}, {}; {}", c.name, c.words, c.value, words_of_limit(c),
                    soft ? how_much_harder(scene, c.value, c.limit) : why_it_moves(scene, record.confined.seconds)));
  }
}

void add_density(const RunRecord& record, std::vector<std::string>& missed) {
  const DensityTarget& wanted = record.density;
  const double got = record.density_is_before_stress() ? record.confined.phi_before : record.phi_bulk;
  const double off = got - wanted.fraction;
  if (!wanted.on() || std::abs(off) <= wanted.tolerance) return;
  missed.push_back(
      fmt::format("{}: the bulk has solid fraction {:.4f} (porosity {:.4f}, void ratio {:.4f}), it is to be {:.4f} "
                  "within {:g}; use "
                  "thinner layers, which correct more often, another seed, or a wider target.tolerance",
                  wanted.key, got, porosity(got), void_ratio(got), wanted.fraction, wanted.tolerance));
}

// Where the stress is not what was asked for, and what to change.
void add_confined(const scene::Scene& scene, const confine::Outcome& got, std::vector<std::string>& missed) {
  if (!got.on) return;
  const std::string more = fmt::format(
      "it needs more time: raise confinement.wait (now {:.3g} s) or "
      "contact.damping_ratio ({:.3g})",
      got.seconds, scene.in.contact.damping_ratio);
  const auto off = [&](std::size_t k, const char* key, const std::string& words) {
    if (std::abs(got.misfit.at(k)) <= got.tolerance) return;
    missed.push_back(fmt::format("confinement.{}: {}, off by {:.2g} of what was asked for, beyond {:g}; {}", key, words,
                                 std::abs(got.misfit.at(k)), got.tolerance, more));
  };
  const char* vertical = scene.in.confinement->isotropic ? "isotropic" : "vertical";
  off(0, vertical, fmt::format("the lid bears {:.4g} Pa of {:.4g} Pa", got.on_lid, got.vertical));
  off(1, vertical,
      fmt::format("the contacts bear {:.4g} Pa, and lid and weight want {:.4g} Pa", got.of_contacts.back(),
                  got.vertical_at_rest));
  off(2, scene.in.confinement->isotropic ? "isotropic" : "lateral",
      fmt::format("the sides do not bear {:.4g} Pa", got.lateral));
}

void add_audit(const Audit& audit, std::vector<std::string>& missed) {
  if (audit.found != audit.expected) {
    missed.push_back(fmt::format("{} of {} particles are there", audit.found, audit.expected));
  }
  if (audit.non_finite > 0) missed.push_back(fmt::format("{} particles are not finite", audit.non_finite));
  if (audit.outside > 0) missed.push_back(fmt::format("{} particles are outside the container", audit.outside));
  const double worst = std::max(audit.worst_overlap, audit.worst_wall_penetration);
  if (!(worst < deepest)) {
    missed.push_back(
        fmt::format("the deepest overlap is {:.3g} of a radius, beyond the {:g} that the contact law is "
                    "for: use a larger particles.youngs_modulus",
                    worst, deepest));
  }
}

// Strata and small shares round to whole particles: of what was asked for there may be none.
void add_components(const input::Input& in, const observe::Composition& composition, std::vector<std::string>& missed) {
  for (std::size_t k = 0; k < composition.parts.size(); ++k) {
    const bool asked = in.strata.empty() ? in.components[k].share > 0.0
                                         : std::ranges::any_of(in.strata, [&](const input::Stratum& one) {
                                             return input::share_in(in, one, k) > 0.0;
                                           });
    if (!asked || composition.parts[k].count > 0) continue;
    missed.push_back(
        fmt::format("component \"{}\": the pack has no particle of it; give it a larger share, or its "
                    "stratum more mass or height",
                    composition.parts[k].name));
  }
}

}  // namespace

std::vector<Criterion> judge(const scene::Scene& scene, const observe::Rest& rest) {
  const input::Rest& limits = scene.in.rest;
  const bool moves = !insertion_alone(scene.in);
  const bool weighs = moves && scene.in.jamming.gravity > 0.0;
  const double none = std::numeric_limits<double>::infinity();
  return {{.name = "unbalanced_force",
           .words = "unbalanced force ratio",
           .value = rest.unbalanced_force,
           .limit = moves ? limits.unbalanced_force : none},
          {.name = "kinetic_energy",
           .words = "mean kinetic energy over m g d",
           .value = rest.kinetic_energy,
           .limit = weighs ? limits.kinetic_energy : none},
          {.name = "support",
           .words = "force of floor and walls over weight",
           .value = rest.support,
           .limit = weighs ? limits.support : none,
           .target = 1.0},
          {.name = "mean_overlap",
           .words = "mean overlap over radius",
           .value = rest.mean_overlap,
           .limit = limits.mean_overlap,
           .of_overlap = true},
          {.name = "worst_overlap",
           .words = "worst overlap over radius",
           .value = rest.worst_overlap,
           .limit = limits.worst_overlap,
           .of_overlap = true}};
}

bool at_rest(const std::vector<Criterion>& criteria) {
  return std::ranges::all_of(criteria, [](const Criterion& c) { return c.of_overlap || c.met(); });
}

std::vector<std::string> missed_targets(const scene::Scene& scene, const RunRecord& record) {
  std::vector<std::string> missed;
  if (!record.reached && record.target_particles > 0) {
    missed.push_back(
        fmt::format("particles.count: {} of {} particles are there after {} layers, the most there are ({})",
                    record.particles, record.target_particles, record.layers.size(), record.stop_reason));
  } else if (!record.reached) {
    missed.push_back(
        fmt::format("container.{}: the height is {:.4g} m of {:.4g} m after {} layers, the most there are ({})",
                    scene.container.is_box() ? "size" : "height", record.height, record.target_height,
                    record.layers.size(), record.stop_reason));
  }
  add_components(scene.in, record.composition, missed);
  add_density(record, missed);
  add_confined(scene, record.confined, missed);
  add_audit(record.audit, missed);
  add_rest(scene, record, missed);
  return missed;
}

void check_energy(const scene::Scene& scene, const std::vector<LayerRow>& layers, std::size_t first) {
  constexpr std::size_t few = 3;
  constexpr double growth = 5.0, noticeable = 0.01;  // [-], m g d
  if (layers.size() < first + 2 * few) return;
  const auto less = [](const LayerRow& a, const LayerRow& b) { return a.kinetic_per_mgd < b.kinetic_per_mgd; };
  const auto begin = layers.begin() + static_cast<std::ptrdiff_t>(first);
  const double most_before = std::max_element(begin, begin + few, less)->kinetic_per_mgd;
  const double least_now = std::min_element(layers.end() - few, layers.end(), less)->kinetic_per_mgd;
  if (!(least_now > std::max({growth * most_before, noticeable, scene.in.rest.kinetic_energy}))) return;
  throw Error(
      ExitCode::numerical_failure,
      fmt::format("layer {}: the energy of the bed grows from layer to layer: {:.2g} m g d at most after one of "
                  "the first {}, {:.2g} m g d at least after one of the last {}; {}",
                  layers.size(), most_before, few, least_now, few, why_it_moves(scene, 0.0)));
}

}  // namespace packmpi::report
