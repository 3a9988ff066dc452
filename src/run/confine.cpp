#include "run/confine.hpp"

#include <fmt/core.h>

#include "confine/press.hpp"
#include "observe/rest.hpp"
#include "report/judge.hpp"

namespace packmpi::run {
namespace {

void begin(Bed& bed, Attendant& attendant) {
  const double before = observe::density(bed.comm, bed.store, bed.scene, bed.bulk()).phi_bulk;
  const bool full = bed.full();
  confine::State& now = bed.progress.confined;
  now = confine::begin(bed.scene, bed.top());
  now.phi_before = before;
  now.full = full;
  confine::apply(now, *bed.box);
  bed.balance();
  attendant.remark(fmt::format("confinement: a lid comes down from {:.6g} m until it bears {:.4g} Pa", now.lid,
                               bed.scene.in.confinement->on_lid()));
}

}  // namespace

void confine_bed(Bed& bed, Attendant& attendant) {
  const scene::Scene& scene = bed.scene;
  if (!scene.in.confinement) return;
  confine::State& now = bed.progress.confined;
  if (!now.on) begin(bed, attendant);
  attendant.relaxation_started();
  bed.stepper.use({scene.confining_step, scene.in.particles.youngs_modulus});
  const double given = bed.progress.energy_given - now.work;
  const auto rests = [&] {
    return report::at_rest(report::judge(scene, observe::rest(bed.comm, bed.store, scene, bed.neighborhood)));
  };
  const auto book = [&] { bed.progress.energy_given = given + now.work; };  // before it is told or kept
  confine::Press press(bed.comm, scene, *bed.box, now, bed.store, bed.neighborhood, bed.ownership);
  press.run({.step = [&] { bed.advance(1); },
             .at_rest = rests,
             .stop = [&] { bed.stop(); },
             .moment = [&](double share) { book(), attendant.moment(share); },
             .steps_to_look = [&] { return attendant.steps_to_look(); },
             .look = [&] { book(), attendant.look(); }});
  bed.check();
}

}  // namespace packmpi::run
