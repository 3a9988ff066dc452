#include "run/trial.hpp"

#include "observe/measure.hpp"
#include "run/bed.hpp"
#include "run/confine.hpp"
#include "run/fill.hpp"

namespace packmpi::run {
namespace {

// Looks at the bulk when the final stage begins, and lets others look.
class Onlooker final : public Attendant {
 public:
  Onlooker(const Bed& bed, const Look& look) : bed_(bed), look_(look) {}
  void relaxation_started() override {  // again when a lid comes
    if (filled_ == 0.0) filled_ = solid_fraction();
  }
  [[nodiscard]] std::int64_t steps_to_look() const override { return 25; }
  void look() override {
    if (look_) look_();
  }
  void layer_ended() override { look(); }
  void look_while_inserting(LocalIndex /*before*/) override { look(); }
  [[nodiscard]] double filled() const noexcept { return filled_; }
  [[nodiscard]] double solid_fraction() const {
    return observe::density(bed_.comm, bed_.store, bed_.scene, bed_.bulk()).phi_bulk;
  }

 private:
  const Bed& bed_;
  const Look& look_;
  double filled_ = 0.0;
};

}  // namespace

control::Trial try_knob(const control::Sample& sample, control::Knob knob, const Look& look) {
  const comm::Comm alone(MPI_COMM_SELF);
  scene::Scene scene = sample.scene;  // a lid changes its container
  Bed bed(alone, scene);
  bed.box = &scene.container;
  bed.progress.filling.on = true;
  bed.progress.filling.knob = knob;
  Onlooker onlooker(bed, look);
  fill(bed, onlooker);
  if (control::confined_density(scene)) confine_bed(bed, onlooker);
  const double relaxed = onlooker.solid_fraction();
  const double filled = onlooker.filled() > 0.0 ? onlooker.filled() : relaxed;
  const observe::Contacts contacts =
      observe::contacts(alone, bed.store, bed.scene, bed.neighborhood.pairs(), bed.neighborhood.walls());
  std::vector<double> slabs = bed.progress.filling.layer_fractions;
  for (double& fraction : slabs) fraction *= sample.scale;
  return {knob, sample.scale * filled, sample.scale * relaxed, contacts.coordination, slabs};
}

}  // namespace packmpi::run
