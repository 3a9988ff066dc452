#include "run/journal.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/log.hpp"
#include "base/terminal.hpp"
#include "base/text.hpp"
#include "observe/measure.hpp"

namespace packmpi::run {
namespace {

constexpr double terminal_interval = 0.2;  // [s] between rewrites of the progress line
constexpr double plain_interval = 20.0;    // [s] between plain lines
// A settled bed has about this solid fraction; only for the estimate of the time left before a layer has shown it.
double usual_fraction(int dimension) { return dimension == 3 ? 0.6 : 0.84; }

}  // namespace

Journal::Journal(Bed& bed, const std::string& steps_path, bool quiet, bool restarted)
    : bed_(bed),
      steps_(bed.comm, steps_path, bed.progress.series, restarted),
      terminal_(stderr_is_terminal()),
      quiet_(quiet),
      height_(bed.progress.layers.empty() ? 0.0 : bed.progress.layers.back().height),
      layers_done_(static_cast<int>(bed.progress.layers.size())),
      layers_before_(layers_done_) {}

void Journal::layer_inserted(const report::LayerRow& row) {
  log::debug(fmt::format("inserted {} particles in {} trials, solid fraction {:.4f} of the region from {:.6g} m up",
                         row.inserted, row.attempts, row.achieved_fraction, row.region_bottom));
  log::event_for_programs("layer_inserted", {{"layer", std::int64_t{layers_done_} + 1},
                                             {"inserted", row.inserted},
                                             {"trials", row.attempts},
                                             {"fraction", row.achieved_fraction},
                                             {"bottom", row.region_bottom}});
}

void Journal::moment(double share) {
  const observe::Ledger now = observe::ledger(bed_.comm, bed_.store, bed_.scene, bed_.stepper.law(), bed_.neighborhood,
                                              bed_.progress.moving_from);
  const double energy = now.kinetic_energy + now.potential_energy + now.elastic_energy;
  const double top = bed_.top();
  const double force = bed_.comm.max(bed_.stepper.last().max_force);
  steps_.append({.layer = static_cast<std::int32_t>(bed_.progress.first_ids.size()) - 1,
                 .step = bed_.progress.steps,
                 .time = bed_.time(),
                 .particles = bed_.progress.count,
                 .kinetic_energy = now.kinetic_energy,
                 .max_speed = now.max_speed,
                 .top = top,
                 .mean_height = now.mean_height,
                 .max_force = force,
                 .rebuilds = bed_.neighborhood.rebuilds(),
                 .moving = bed_.progress.count - bed_.progress.moving_from,
                 .rotational_energy = now.rotational_energy,
                 .potential_energy = now.potential_energy,
                 .elastic_energy = now.elastic_energy,
                 .dissipated = bed_.progress.energy_given - energy,
                 .momentum = now.momentum});
  if (bed_.comm.rank() == 0 && !quiet_) progress(share, now.kinetic_energy, top);
}

// Particle-steps still to do over those done, both reckoned from the layers, at the rate so far.
double Journal::seconds_left(double share) const {
  const input::Input& in = bed_.scene.in;
  const double asked = bed_.scene.container.height();
  const double per_layer =
      layers_done_ > 1 ? height_ / layers_done_
                       : in.layers.fraction * in.layers.thickness / usual_fraction(bed_.scene.container.dimension);
  const double begun = layers_done_ + (relaxing_ ? 0.0 : 1.0);
  double layers = std::max(std::ceil(asked / per_layer), begun);
  if (in.layers.maximum > 0) layers = std::min(layers, static_cast<double>(in.layers.maximum));
  if (relaxing_) layers = begun;
  const double window = in.dynamics.window;
  const auto moving = [&](double n) { return window > 0.0 ? std::min(n, window) : n; };  // layers, in the n-th's time
  const auto moved = [&](double n) {  // sum of moving(k) over k = 1 .. n
    const double m = moving(n);
    return 0.5 * m * (m + 1.0) + m * (n - m);
  };
  const double final_stage =  // in units of a layer's steps
      layers * (bed_.scene.relaxation / bed_.scene.time_step) / (in.layers.duration / bed_.scene.settling.time_step);
  const double all = moved(layers) + final_stage;
  const double done = moved(layers_done_) + share * (relaxing_ ? final_stage : moving(begun));
  const double here = done - moved(layers_before_);  // about: since a restart
  return here > 0.0 ? watch_.seconds() * (all - done) / here : -1.0;
}

void Journal::progress(double share, double kinetic_energy, double top) {
  const double now = watch_.seconds();
  if (now - last_shown_ < (terminal_ ? terminal_interval : plain_interval)) return;
  last_shown_ = now;
  const double steps =
      static_cast<double>(bed_.stepper.work().particle_steps) * bed_.comm.size();  // about: all ranks alike
  const bool waits = relaxing_ && share >= 1.0;                                    // for rest: nobody knows how long
  const double left = waits ? -1.0 : seconds_left(share);
  log::event_for_programs("progress", {{"phase", std::string(relaxing_ ? "relaxation" : "layer")},
                                       {"layer", std::ssize(bed_.progress.first_ids)},
                                       {"share", share},
                                       {"time", bed_.time()},
                                       {"particles", bed_.progress.count},
                                       {"moving", bed_.progress.count - bed_.progress.moving_from},
                                       {"top", top},
                                       {"kinetic_energy", kinetic_energy},
                                       {"particle_steps_per_second", steps / now},
                                       {"seconds_left", left}});
  // Under 80 columns: a longer line would wrap, and a wrapped line cannot be rewritten.
  const std::string line =
      fmt::format("{} {:3d} {:3.0f} %  {} moving  top {:.4g} m  KE {:.1e} J  {:.1f}e6 steps/s  {}",
                  relaxing_ ? "relaxation" : "layer", bed_.progress.first_ids.size(), 100.0 * share,
                  bed_.progress.count - bed_.progress.moving_from, top, kinetic_energy, steps / now * 1e-6,
                  waits ? "until at rest" : text::duration(left) + " left");
  if (terminal_) {
    note(fmt::format("\r{}\033[K", line));
  } else {
    note(line + "\n");
  }
}

void Journal::layer_settled(const report::LayerRow& row) {
  ++layers_done_;
  height_ = row.height;
  const std::string line = fmt::format(
      "layer {:3d} after {:.3g} s ({}): {} particles, height {:.4f} m, top {:.4f} m, KE/(m g d) {:.1e}, contacts "
      "{:.2f}, overlap "
      "at most {:.1e} r",
      layers_done_, row.duration, row.stop_reason, row.total, row.height, row.top, row.kinetic_per_mgd,
      row.coordination, row.max_overlap);
  tell("layer_settled", line,
       {{"layer", std::int64_t{layers_done_}},
        {"time", bed_.time()},
        {"duration", row.duration},
        {"stop_reason", row.stop_reason},
        {"particles", row.total},
        {"height", row.height},
        {"top", row.top},
        {"kinetic_per_mgd", row.kinetic_per_mgd},
        {"coordination", row.coordination},
        {"max_overlap", row.max_overlap}});
}

void Journal::filling_begins() const {
  const control::Filling& filling = bed_.progress.filling;
  if (!filling.on) return;
  log::info(fmt::format("target: solid fraction {:.4f}; friction while filling {:.4g}, {}", filling.target,
                        control::friction_of(bed_.scene.in, filling.knob).particles,
                        filling.knobs.empty() ? "as tried with the scene itself" : "corrected from layer to layer"));
}

void Journal::layer_measured(const control::Filling& filling) const {
  const scene::Friction friction = control::friction_of(bed_.scene.in, filling.layer_knobs.back());
  const double measured = filling.layer_fractions.back();
  const std::string rolling =
      bed_.scene.features.rolling ? fmt::format(", rolling friction {:.3g}", friction.rolling) : "";
  const std::string words = measured > 0.0 ? fmt::format("{:.4f}", measured) : "not yet measured";
  tell("layer_measured",
       fmt::format("layer {:3d}: friction while filling {:.4g}{}, solid fraction {}, target {:.4f}",
                   filling.layer_knobs.size(), friction.particles, rolling, words, filling.target),
       {{"layer", std::ssize(filling.layer_knobs)},
        {"friction", friction.particles},
        {"rolling_friction", friction.rolling},
        {"solid_fraction", measured},
        {"target", filling.target}});
}

void Journal::relaxation_started() { relaxing_ = true; }

void Journal::relaxation_not_needed() { relaxing_ = false; }

void Journal::relaxed(double height, double duration) {
  tell("relaxed",
       fmt::format("relaxation: all {} particles moved for {:.4g} s, height {:.4f} -> {:.4f} m", bed_.progress.count,
                   duration, height_, height),
       {{"particles", bed_.progress.count}, {"duration", duration}, {"height_before", height_}, {"height", height}});
  height_ = height;
  relaxing_ = false;
}

// On a terminal the progress line gives way.
void Journal::tell(const std::string& event, const std::string& line, std::initializer_list<log::Field> fields) const {
  if (bed_.comm.rank() == 0 && terminal_ && !quiet_) note("\r\033[K");
  log::event(event, line, fields);
}

std::int64_t Journal::finish() { return steps_.close(); }

}  // namespace packmpi::run
