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
// A settled pile has about this solid fraction; only for the estimate of the time left before a layer has shown it.
double usual_fraction(int dimension) { return dimension == 3 ? 0.6 : 0.84; }

}  // namespace

Journal::Journal(const Pile& pile, const std::string& steps_path, bool quiet, bool restarted,
                 const std::vector<report::LayerRow>& layers)
    : pile_(pile),
      steps_(pile.comm, steps_path, restarted ? std::optional(pile.steps) : std::nullopt),
      terminal_(stdout_is_terminal()),
      quiet_(quiet),
      height_(layers.empty() ? 0.0 : layers.back().height),
      layers_done_(static_cast<int>(layers.size())),
      layers_before_(layers_done_) {}

void Journal::layer_inserted(const report::LayerRow& row) {
  log::debug(fmt::format("inserted {} particles in {} darts, solid fraction {:.4f} of the region from {:.6g} m up",
                         row.inserted, row.attempts, row.fraction_got, row.region_bottom));
  log::event_for_programs("layer_inserted", {{"layer", std::int64_t{layers_done_} + 1},
                                             {"inserted", row.inserted},
                                             {"darts", row.attempts},
                                             {"fraction", row.fraction_got},
                                             {"bottom", row.region_bottom}});
}

void Journal::moment(double share) {
  const observe::Ledger now =
      observe::ledger(pile_.comm, pile_.store, pile_.scene, pile_.stepper.law(), pile_.neighborhood, pile_.moving_from);
  const double energy = now.kinetic_energy + now.potential_energy + now.elastic_energy;
  const double top = pile_.top();
  const double force = pile_.comm.max(pile_.stepper.last().max_force);
  steps_.append({.layer = static_cast<std::int32_t>(pile_.first_ids.size()) - 1,
                 .step = pile_.steps,
                 .time = pile_.time(),
                 .particles = pile_.count,
                 .kinetic_energy = now.kinetic_energy,
                 .max_speed = now.max_speed,
                 .top = top,
                 .mean_height = now.mean_height,
                 .max_force = force,
                 .rebuilds = pile_.neighborhood.rebuilds(),
                 .moving = pile_.count - pile_.moving_from,
                 .rotational_energy = now.rotational_energy,
                 .potential_energy = now.potential_energy,
                 .elastic_energy = now.elastic_energy,
                 .dissipated = pile_.energy_given - energy,
                 .momentum = now.momentum});
  if (pile_.comm.rank() == 0 && !quiet_) progress(share, now.kinetic_energy, top);
}

// Particle-steps still to do over those done, both reckoned from the layers, at the rate so far.
double Journal::seconds_left(double share) const {
  const input::Input& in = pile_.scene.in;
  const double asked = pile_.scene.box.height();
  const double per_layer = layers_done_ > 1
                               ? height_ / layers_done_
                               : in.layers.fraction * in.layers.thickness / usual_fraction(pile_.scene.box.dimension);
  const double begun = layers_done_ + (thawing_ ? 0.0 : 1.0);
  double layers = std::max(std::ceil(asked / per_layer), begun);
  if (in.layers.maximum > 0) layers = std::min(layers, static_cast<double>(in.layers.maximum));
  if (thawing_) layers = begun;
  const double window = in.dynamics.window;
  const auto moving = [&](double n) { return window > 0.0 ? std::min(n, window) : n; };  // layers, in the n-th's time
  const auto moved = [&](double n) {  // sum of moving(k) over k = 1 .. n
    const double m = moving(n);
    return 0.5 * m * (m + 1.0) + m * (n - m);
  };
  const double final_stage =  // in units of a layer's steps
      layers * (pile_.scene.thaw / pile_.scene.time_step) / (in.layers.duration / pile_.scene.settling.time_step);
  const double all = moved(layers) + final_stage;
  const double done = moved(layers_done_) + share * (thawing_ ? final_stage : moving(begun));
  const double here = done - moved(layers_before_);  // about: since a restart
  return here > 0.0 ? watch_.seconds() * (all - done) / here : -1.0;
}

void Journal::progress(double share, double kinetic_energy, double top) {
  const double now = watch_.seconds();
  if (now - last_shown_ < (terminal_ ? terminal_interval : plain_interval)) return;
  last_shown_ = now;
  const double steps =
      static_cast<double>(pile_.stepper.work().particle_steps) * pile_.comm.size();  // about: all ranks alike
  const double left = seconds_left(share);
  log::event_for_programs("progress", {{"phase", std::string(thawing_ ? "thaw" : "layer")},
                                       {"layer", std::ssize(pile_.first_ids)},
                                       {"share", share},
                                       {"time", pile_.time()},
                                       {"particles", pile_.count},
                                       {"moving", pile_.count - pile_.moving_from},
                                       {"top", top},
                                       {"kinetic_energy", kinetic_energy},
                                       {"particle_steps_per_second", steps / now},
                                       {"seconds_left", left}});
  // Under 80 columns: a longer line would wrap, and a wrapped line cannot be rewritten.
  const std::string line =
      fmt::format("{} {:3d} {:3.0f} %  {} moving  top {:.4g} m  KE {:.1e} J  {:.1f}e6 steps/s  {} left",
                  thawing_ ? "thaw" : "layer", pile_.first_ids.size(), 100.0 * share, pile_.count - pile_.moving_from,
                  top, kinetic_energy, steps / now * 1e-6, text::duration(left));
  if (terminal_) {
    fmt::print("\r{}\033[K", line);
  } else {
    fmt::print("{}\n", line);
  }
  std::fflush(stdout);
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
        {"time", pile_.time()},
        {"duration", row.duration},
        {"stop_reason", row.stop_reason},
        {"particles", row.total},
        {"height", row.height},
        {"top", row.top},
        {"kinetic_per_mgd", row.kinetic_per_mgd},
        {"coordination", row.coordination},
        {"max_overlap", row.max_overlap}});
}

void Journal::thaw_started() { thawing_ = true; }

void Journal::thawed(double height) {
  tell("thawed",
       fmt::format("thaw: all {} particles moved for {:.4g} s, height {:.4f} -> {:.4f} m", pile_.count,
                   pile_.scene.thaw, height_, height),
       {{"particles", pile_.count}, {"duration", pile_.scene.thaw}, {"height_before", height_}, {"height", height}});
  height_ = height;
  thawing_ = false;
}

// On a terminal the progress line gives way.
void Journal::tell(const std::string& event, const std::string& line, std::initializer_list<log::Field> fields) const {
  if (pile_.comm.rank() == 0 && terminal_ && !quiet_) fmt::print("\r\033[K");
  std::fflush(stdout);
  log::event(event, line, fields);
}

void Journal::finish() { steps_.close(); }

}  // namespace packmpi::run
