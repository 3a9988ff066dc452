#include "exporters/springs.hpp"

#include <fmt/format.h>

namespace packmpi::exporters {
namespace {

constexpr double still = 1e-4;  // of m g d, the usual limit of rest.kinetic_energy
constexpr double made = 1e-3;   // of the longest spring: what is farther off does not hold the pack

/// The whole pack, of which a part may be written, or copies.
bool at_rest(const pack::PackFile& file, const scene::Scene& scene) {
  const double weight = file.number("/summary", "weight");
  return file.number("/summary", "kinetic_energy") <= still * weight * 2.0 * scene.sizes.mean();
}

}  // namespace

SpringsPlan plan_springs(const ConvertRequest& request, const scene::Scene& scene, SpringsBy by, bool stored) {
  if (scene.in.contact.tangential != input::Tangential::mindlin || by == SpringsBy::none) return {};
  const bool whole = request.cut.empty() && request.trim == Trim::none && request.copies[0] * request.copies[1] == 1;
  if (!stored) return {by, "the pack does not have them; make it with output.contacts = true"};
  if (by == SpringsBy::forces) return {by, whole ? "" : "they are for the whole pack alone"};
  return {by, scene.features.rolling ? "as those of rolling cannot be, and either alone does not keep it at rest" : ""};
}

void take_springs(const comm::Comm& comm, const pack::PackFile& file, SpringsPlan& plan, Specimen& s) {
  if (!plan.on()) return;
  if (plan.by == SpringsBy::forces) {
    comm::agree_on(comm, [&] {
      if (comm.rank() == 0) s.touching = file.touching();
    });
    return;
  }
  if (!at_rest(file, s.scene)) {
    plan.missing = "as the pack moves; its velocities are";
    return;
  }
  using handover::Arm;
  s.springs = handover::motions_of(comm, file, plan.by == SpringsBy::motion_of_radii ? Arm::radius : Arm::middle);
  if (s.springs.left <= made) return;
  plan.missing = fmt::format("as no motion makes all of them: one is off by {:.2g} of the longest", s.springs.left);
  s.springs = {};
}

std::string words_of(const SpringsPlan& plan, const Specimen& s) {
  if (plan.by == SpringsBy::none) return "";
  if (!plan.on()) return "not carried over, " + plan.missing;
  if (plan.by == SpringsBy::forces) return "carried over as forces";
  return fmt::format("carried over, each within {:.1g} of the longest", s.springs.left);
}

}  // namespace packmpi::exporters
