#include "run/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "base/log.hpp"
#include "base/voids.hpp"
#include "scene/limits.hpp"

namespace packmpi::run {
namespace {

using control::Knob;
using control::Sample;
using control::Trial;

constexpr int intervals = 4;                    // of friction, and half as many of rolling
constexpr int more_whole = 10, more_small = 2;  // trials after those, nearer to the target
constexpr double same_knob = 1e-3, aside = 0.01;

// Trials i of `count`, shared among the ranks.
template <class Try>
std::vector<Trial> share(const comm::Comm& comm, std::size_t count, std::size_t most_layers, const Look& look,
                         Try&& attempt) {
  constexpr double none = -std::numeric_limits<double>::infinity();
  constexpr std::size_t scalars = 4;
  const std::size_t width = scalars + most_layers;
  std::vector<double> numbers(count * width, none);
  comm::agree_on(comm, [&] {
    if (look) look();  // a rank without a sample, too
    for (auto k = static_cast<std::size_t>(comm.rank()); k < count; k += static_cast<std::size_t>(comm.size())) {
      const Trial trial = attempt(k);
      const std::array<double, scalars> mine{trial.knob, trial.filled, trial.relaxed, trial.coordination};
      const auto into = std::ranges::copy(mine, numbers.begin() + static_cast<std::ptrdiff_t>(k * width)).out;
      std::ranges::copy(trial.slabs, into);
    }
  });
  comm.max(std::span(numbers));
  std::vector<Trial> trials;
  for (std::size_t k = 0; k < numbers.size(); k += width) {
    trials.push_back({numbers[k], numbers[k + 1], numbers[k + 2], numbers[k + 3]});
    for (std::size_t n = scalars; n < width && numbers[k + n] > none; ++n)
      trials.back().slabs.push_back(numbers[k + n]);
  }
  return trials;
}

std::size_t most_layers_of(const Sample& sample) { return static_cast<std::size_t>(scene::most_layers(sample.scene)); }

std::vector<Trial> try_knobs(const comm::Comm& comm, const Sample& sample, const std::vector<Knob>& knobs,
                             const Look& look) {
  std::vector<Trial> trials = share(comm, knobs.size(), most_layers_of(sample), look,
                                    [&](std::size_t k) { return try_knob(sample, knobs[k], look); });
  for (const Trial& trial : trials) {
    const scene::Friction friction = control::friction_of(sample.scene.in, trial.knob);
    log::info(fmt::format(
        "target: friction while filling {:.4g}{} gives solid fraction {:.4f}{} ({:.4f} before the final "
        "relaxation), contacts {:.2f}",
        friction.particles, sample.scene.features.rolling ? fmt::format(", rolling {:.3g}", friction.rolling) : "",
        trial.relaxed, sample.scene.in.target->state == input::TargetState::confined ? " under its stress" : "",
        trial.filled, trial.coordination));
  }
  return trials;
}

std::vector<Knob> first_knobs(const input::Input& in) {
  std::vector<Knob> knobs;
  for (int k = 0; k <= intervals; ++k) knobs.push_back(static_cast<double>(k) / intervals);
  for (Knob knob = 1.5; knob <= control::loosest_knob(in); knob += 0.5) knobs.push_back(knob);
  return knobs;
}

const Trial& best_of(const std::vector<Trial>& trials, double target) {
  return *std::ranges::min_element(trials, {}, [&](const Trial& trial) { return std::abs(trial.relaxed - target); });
}

// The knob to try next; a little aside of one that was tried: what comes of it differs by chance.
Knob next_knob(const std::vector<Trial>& trials, double target) {
  const Knob most = std::ranges::max(trials, {}, &Trial::knob).knob;
  const Knob knob = control::knob_for(control::curve_of(trials), target);
  const auto tried = [&](Knob one) {
    return std::ranges::any_of(trials, [&](const Trial& trial) { return std::abs(trial.knob - one) < same_knob; });
  };
  Knob next = knob;
  for (int step = 1; tried(next); ++step) {
    const Knob up = knob + step * aside, down = knob - step * aside;
    next = up <= most && !tried(up) ? up : std::max(0.0, down);
  }
  return next;
}

std::string density_words(double fraction) {
  return fmt::format("solid fraction {:.4f} (porosity {:.4f}, void ratio {:.4f})", fraction, porosity(fraction),
                     void_ratio(fraction));
}

void check_possible(const comm::Comm& comm, const Sample& sample, const control::Limits& limits, double wanted) {
  const input::Input& in = sample.scene.in;
  const double tolerance = in.target->tolerance;
  if (wanted <= limits.densest + tolerance && wanted >= limits.loosest - tolerance) return;
  const scene::Friction loosest = control::friction_of(in, control::loosest_knob(in));
  const bool loose = wanted < limits.loosest;
  comm::fail_together(
      comm, ExitCode::bad_input,
      fmt::format("{}: {}: {} is out of what this scene can have: from {} at friction {:g}{} while filling to {} at "
                  "friction {:g}, on a sample of about {:.0f} particles; {}",
                  in.file, target_key(*in.target), density_words(wanted), density_words(limits.loosest),
                  loosest.particles,
                  loosest.rolling > 0.0 ? fmt::format(" and rolling friction {:g}", loosest.rolling) : "",
                  density_words(limits.densest), input::least_filling_friction, sample.particles,
                  loose ? "raise target.most_friction or target.most_rolling_friction, or contact.friction and "
                          "contact.rolling_friction"
                        : "no friction makes it denser: change the sizes, or give a looser target"));
}

}  // namespace

std::string target_key(const input::Target& target) {
  return target.solid_fraction ? "target.solid_fraction"
         : target.porosity     ? "target.porosity"
         : target.void_ratio   ? "target.void_ratio"
                               : "target.relative_density";
}

std::int64_t most_trials(const Sample& sample) {
  return std::ssize(first_knobs(sample.scene.in)) + (sample.whole ? more_whole : more_small);
}

control::Limits Extremes::limits() const {
  const auto mean = [](const std::vector<Trial>& trials) {
    double sum = 0.0;
    for (const Trial& trial : trials) sum += trial.relaxed;
    return sum / static_cast<double>(trials.size());
  };
  return {mean(loosest), mean(densest)};
}

Extremes find_extremes(const comm::Comm& comm, const scene::Scene& scene, const Look& look) {
  Extremes found;
  std::vector<Sample> samples;
  for (int k = 0; k < seeds_of_extremes; ++k) {
    input::Input in = scene.in;
    in.seed += static_cast<std::uint64_t>(k);
    found.seeds.push_back(in.seed);
    samples.push_back(control::sample_of(scene::build(in)));
  }
  const Knob loosest = control::loosest_knob(scene.in);
  const std::vector<Trial> trials =
      share(comm, 2 * samples.size(), most_layers_of(samples.front()), look,
            [&](std::size_t k) { return try_knob(samples[k / 2], k % 2 == 0 ? 0.0 : loosest, look); });
  for (std::size_t k = 0; k < trials.size(); ++k) (k % 2 == 0 ? found.densest : found.loosest).push_back(trials[k]);
  return found;
}

control::Filling find_filling(const comm::Comm& comm, const scene::Scene& scene, const Look& look) {
  const input::Target& target = *scene.in.target;
  const control::Limits limits =
      target.relative_density ? find_extremes(comm, scene, look).limits() : control::Limits{};
  const double wanted = control::fraction_wanted(target, limits);
  const Sample sample = control::sample_of(scene);
  log::info(fmt::format("target: {}; {} tells what friction gives it, of about {:.0f} particles", density_words(wanted),
                        sample.whole ? "the scene itself" : "a sample", sample.particles));
  std::vector<Trial> trials = try_knobs(comm, sample, first_knobs(scene.in), look);
  if (!target.relative_density) check_possible(comm, sample, control::limits_of(control::curve_of(trials)), wanted);
  const double near = sample.whole ? 0.5 * target.tolerance : 0.0;
  for (int k = 0; k < (sample.whole ? more_whole : more_small); ++k) {
    if (std::abs(best_of(trials, wanted).relaxed - wanted) <= near) break;
    const std::vector<Trial> more = try_knobs(comm, sample, {next_knob(trials, wanted)}, look);
    trials.insert(trials.end(), more.begin(), more.end());
  }
  control::Filling filling;
  if (!sample.whole) filling = control::curve_of(trials);
  filling.on = true;
  filling.target = wanted;
  filling.knob =
      sample.whole ? best_of(trials, wanted).knob : control::next_knob(filling, control::squeeze_of(scene, 0.0, {}));
  return filling;
}

}  // namespace packmpi::run
