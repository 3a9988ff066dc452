#include "run/settle.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/log.hpp"
#include "base/timer.hpp"
#include "observe/measure.hpp"
#include "observe/rest.hpp"
#include "report/judge.hpp"

namespace packmpi::run {
namespace {

// Share of a part over which its compaction rate is measured.
constexpr double rate_share = 0.1;
// Looks whether the bed is at rest in the time that the final stage waits for it at most.
constexpr int windows_a_wait = 100;
// The contacts of a high bed that swings as a whole damp that so little that it would swing for longer than all layers
// took. So from the look on at which it is seen to, or after four falls through H_d, all particles are stopped whenever
// their kinetic energy has passed a peak: kinetic damping, as in dynamic relaxation (Cundall 1976). In the last quarter
// of a window they move freely, so that what is looked at is a bed that nothing holds.
constexpr int patience = 40;  // windows
// Whatever its stiffness, a bed swings up and down once in some 26 steps for each diameter of its height.
constexpr double looks_a_diameter = 1.0 / 3.0;
// Looks at the criteria of stop = "settled" in the time for which they must hold.
constexpr int looks_a_hold = 10;
// 2^6 stairs of the hardening ramp: six square roots give the ratio.
constexpr int stair_roots = 6;

// When a part of the run must be interrupted, in steps from its beginning.
struct Plan {
  scene::Stage stage;
  std::int64_t steps;       // in all
  std::int64_t row_every;   // steps between rows of the step log
  std::int64_t look_every;  // steps between looks at the criteria; 0: none
  std::int64_t rate_from;
  std::int64_t wait;         // steps that it goes on at most until the bed is at rest; 0: it does not
  std::int64_t wait_window;  // steps between looks whether it is
  std::int64_t swing_every;  // steps between looks at the energy of a bed that swings
  std::vector<double> ramp;  // moduli; the last one from half the steps on

  [[nodiscard]] std::int64_t ramp_start(std::size_t stair) const {
    return static_cast<std::int64_t>(stair) * (steps / 2) / std::max<std::int64_t>(1, std::ssize(ramp) - 1);
  }
  [[nodiscard]] double modulus(std::int64_t done) const {
    std::size_t stair = ramp.size() - 1;
    while (stair > 0 && ramp_start(stair) > done) --stair;
    return ramp[stair];
  }
  // Of the looks for rest that are due: the first after step `done`, and the last before it.
  [[nodiscard]] std::int64_t window_end(std::int64_t done) const {
    return std::min(steps + wait, steps + ((done - steps) / wait_window + 1) * wait_window);
  }
  [[nodiscard]] std::int64_t window_start(std::int64_t done) const {
    return steps + (done - 1 - steps) / wait_window * wait_window;
  }
  [[nodiscard]] bool look_for_rest(std::int64_t done) const {
    return done >= steps && (done - steps) % wait_window == 0;
  }
  // Is the energy of a bed that swings looked at after step `done`?
  [[nodiscard]] bool damps(std::int64_t done) const {
    return done >= steps && done % swing_every == 0 && 4 * ((done - steps) % wait_window) < 3 * wait_window;
  }
  [[nodiscard]] std::int64_t next(std::int64_t done, bool swings) const {
    std::int64_t stop = std::min(done < steps ? steps : window_end(done), (done / row_every + 1) * row_every);
    if (swings) stop = std::min(stop, (done / swing_every + 1) * swing_every);
    if (look_every > 0) stop = std::min(stop, (done / look_every + 1) * look_every);
    if (done < rate_from) stop = std::min(stop, rate_from);
    for (std::size_t stair = 1; stair < ramp.size(); ++stair) {
      if (ramp_start(stair) > done) return std::min(stop, ramp_start(stair));
    }
    return stop;
  }
};

std::int64_t steps_a_swing_look(const scene::Scene& scene) {
  const double diameters = scene.container.height() / (2.0 * scene.sizes.mean());
  return std::max<std::int64_t>(1, std::llround(looks_a_diameter * diameters));
}

Plan plan_of(const scene::Scene& scene, Part part) {
  const bool layer = part == Part::layer;
  const scene::Stage stage = layer ? scene.settling : scene.last();
  const double seconds = layer ? scene.in.layers.duration : scene.relaxation;
  const double wait = layer ? 0.0 : scene.wait;
  Plan plan{.stage = stage,
            .steps = seconds > 0.0 ? scene::steps_in(seconds, stage.time_step) : 0,
            .row_every = scene::steps_a_row(scene.in.output, stage.time_step),
            .look_every = 0,
            .rate_from = 0,
            .wait = wait > 0.0 ? scene::steps_in(wait, stage.time_step) : 0,
            .wait_window = scene::steps_in(wait / windows_a_wait, stage.time_step),
            .swing_every = steps_a_swing_look(scene),
            .ramp = hardening(layer ? stage.youngs_modulus : scene.settling.youngs_modulus, stage.youngs_modulus)};
  if (layer && scene.in.dynamics.stop == input::StopRule::settled) {
    plan.look_every = scene::steps_in(scene.in.dynamics.settled_hold / looks_a_hold, stage.time_step);
  }
  plan.rate_from = plan.steps - std::max<std::int64_t>(1, std::llround(rate_share * static_cast<double>(plan.steps)));
  return plan;
}

double phi_of_moving(const Bed& bed) { return observe::density(bed.comm, bed.store, bed.scene, bed.bulk()).phi_bulk; }

// One of the criteria of rest: what it measures, and below what it is met.
struct Criterion {
  const char* words;
  double value, limit;
  [[nodiscard]] bool met() const noexcept { return value < limit; }  // not for NaN
};

// Says it when a criterion is met for the first time in this part.
void tell(Bed& bed, const Plan& plan, const Criterion& criterion, std::int64_t bit, Attendant& attendant) {
  pack::PhaseProgress& now = bed.progress.now;
  const double time = static_cast<double>(now.done) * plan.stage.time_step;
  log::debug(fmt::format("{} {:.2e} after {:.4g} s", criterion.words, criterion.value, time));
  if (!criterion.met() || (now.told & bit) != 0) return;
  now.told |= bit;
  attendant.remark(fmt::format("layer {:3d}: {} {:.2e}, below {:g}, after {:.4g} s", bed.progress.first_ids.size(),
                               criterion.words, criterion.value, criterion.limit, time));
}

// Are all criteria met? The dear one, which costs about two steps, is looked at only if the others are.
bool is_calm(Bed& bed, const Plan& plan, Attendant& attendant) {
  pack::PhaseProgress& now = bed.progress.now;
  const input::Dynamics& limits = bed.scene.in.dynamics;
  const double g = bed.scene.in.jamming.gravity;
  const double d = 2.0 * bed.scene.sizes.mean();
  const observe::Motion motion = observe::motion(bed.comm, bed.store, bed.scene);
  const double time = static_cast<double>(plan.look_every) * plan.stage.time_step;
  const double drift = std::abs(motion.mean_height - now.mean_height) / time / std::sqrt(g * d);
  now.mean_height = motion.mean_height;
  const Criterion energy{"KE/(m g d)", motion.kinetic_energy / (motion.mass * g * d), limits.settled_energy};
  const Criterion sinking{"drift/sqrt(g d)", drift, limits.settled_drift};
  tell(bed, plan, energy, 1, attendant);
  tell(bed, plan, sinking, 2, attendant);
  if (!energy.met() || !sinking.met()) return false;
  const double ratio = observe::unbalanced_force(bed.comm, bed.store, bed.scene, bed.stepper.law(), bed.neighborhood,
                                                 bed.progress.moving_from);
  const Criterion balance{"unbalanced force ratio", ratio, limits.settled_force};
  tell(bed, plan, balance, 4, attendant);
  return balance.met();
}

// Looks whether the moving particles have come to rest, and for how long. True if long enough.
bool has_settled(Bed& bed, const Plan& plan, Attendant& attendant) {
  pack::PhaseProgress& now = bed.progress.now;
  if (!is_calm(bed, plan, attendant)) {
    now.calm_since = -1;
    return false;
  }
  if (now.calm_since < 0) {
    now.calm_since = now.done;
    now.phi_calm = phi_of_moving(bed);
  }
  return static_cast<double>(now.done - now.calm_since) * plan.stage.time_step >=
         bed.scene.in.dynamics.settled_hold * (1.0 - 1e-9);
}

Settled result(const Bed& bed, const Plan& plan, bool early) {
  const pack::PhaseProgress& now = bed.progress.now;
  if (now.done == 0) return {};
  const double before = early ? now.phi_calm : now.phi_before;
  const std::int64_t since = early                   ? now.calm_since
                             : now.done > plan.steps ? plan.window_start(now.done)
                                                     : plan.rate_from;
  const double time = static_cast<double>(now.done - since) * plan.stage.time_step;
  return {.steps = now.done,
          .seconds = static_cast<double>(now.done) * plan.stage.time_step,
          .compaction_rate = (phi_of_moving(bed) - before) / time,
          .early = early};
}

// Forces on particles balance, and floor and walls bear more or less than the weight: particles bounce and fall no
// more, and the bed moves as one. Stopping particles that fall would keep them from coming to rest.
bool swings(const observe::Rest& rest, const input::Rest& limits) {
  constexpr double bouncing = 1e-2;  // of m g d
  return rest.unbalanced_force < limits.unbalanced_force && rest.kinetic_energy < bouncing &&
         std::abs(rest.support - 1.0) > limits.support;
}

// Stops all particles if they have slowed down since the last look. Collective.
void damp(Bed& bed) {
  double& before = bed.progress.now.swing.kinetic_energy;
  const double energy = observe::motion(bed.comm, bed.store, bed.scene).kinetic_energy;
  const bool peaked = energy < before;
  if (peaked) bed.stop();
  before = peaked ? 0.0 : energy;
}

// Is the part over after now.done steps? Beyond its own steps, once the bed is at rest; that is looked at in
// windows, from whose beginning the compaction rate counts.
bool is_over(Bed& bed, const Plan& plan) {
  pack::PhaseProgress& now = bed.progress.now;
  if (now.done < plan.steps) return false;
  if (now.done == plan.steps + plan.wait) return true;
  if (!plan.look_for_rest(now.done)) return false;
  const observe::Rest rest = observe::rest(bed.comm, bed.store, bed.scene, bed.neighborhood);
  log::debug(
      fmt::format("unbalanced force ratio {:.2e}, KE/(m g d) {:.2e}, support {:.4f} at step {} of the final stage",
                  rest.unbalanced_force, rest.kinetic_energy, rest.support, now.done));
  if (report::at_rest(report::judge(bed.scene, rest))) return true;
  if (swings(rest, bed.scene.in.rest) || now.done >= plan.steps + patience * plan.wait_window) now.swing.on = true;
  now.phi_before = phi_of_moving(bed);
  return false;
}

// None: the scene's own.
std::optional<scene::Friction> friction_in(const Bed& bed, Part part) {
  const control::Filling& filling = bed.progress.filling;
  if (!filling.on || part == Part::relaxation) return std::nullopt;
  return control::friction_of(bed.scene.in, filling.layer_knobs.back());
}

}  // namespace

std::int64_t steps_of(const scene::Scene& scene, Part part) { return plan_of(scene, part).steps; }

std::vector<double> hardening(double soft, double hard) {
  if (!(soft < hard)) return {hard};
  double ratio = hard / soft;
  for (int root = 0; root < stair_roots; ++root) ratio = std::sqrt(ratio);
  std::vector<double> moduli{soft};
  for (int stair = 1; stair < (1 << stair_roots); ++stair) moduli.push_back(std::min(hard, moduli.back() * ratio));
  moduli.push_back(hard);
  return moduli;
}

Settled settle(Bed& bed, Attendant& attendant, Part part) {
  pack::PhaseProgress& now = bed.progress.now;
  const Plan plan = plan_of(bed.scene, part);
  const std::optional<scene::Friction> friction = friction_in(bed, part);
  if (plan.look_every > 0 && now.done == 0) {
    now.mean_height = observe::motion(bed.comm, bed.store, bed.scene).mean_height;
  }
  bool early = false;
  bool over = is_over(bed, plan);
  while (!over) {
    if (now.swing.on && plan.damps(now.done)) damp(bed);  // after a checkpoint of this step: a restart does it, too
    if (now.done == plan.rate_from) now.phi_before = phi_of_moving(bed);
    const std::int64_t next = std::min(plan.next(now.done, now.swing.on), now.done + attendant.steps_to_look());
    bed.stepper.use({plan.stage.time_step, plan.modulus(now.done), friction});
    bed.advance(next - now.done);
    if (part == Part::relaxation) bed.progress.relaxation_steps += next - now.done;
    now.done = next;
    if (plan.look_every > 0 && next % plan.look_every == 0) early = has_settled(bed, plan, attendant);
    over = early || is_over(bed, plan);
    if (next % plan.row_every == 0 || next == plan.steps || over) {
      attendant.moment(static_cast<double>(next) / static_cast<double>(std::max(next, plan.steps)));
    }
    if (!early) attendant.look();  // a part that is over goes on with what comes after it
  }
  bed.check();  // what comes next takes all particles to be valid
  return result(bed, plan, early);
}

}  // namespace packmpi::run
