#include "confine/outcome.hpp"

#include <algorithm>
#include <cmath>

#include "confine/stress.hpp"

namespace packmpi::confine {
namespace {

void judge(const scene::Scene& scene, Outcome& got) {
  got.misfit = {got.on_lid / got.vertical - 1.0, (got.of_contacts.back() - got.vertical_at_rest) / got.vertical, 0.0};
  if (!(got.lateral > 0.0)) return;
  for (std::size_t a = 0; a < got.size.size(); ++a) {
    const double side = (scene.container.periodic[a] ? got.of_contacts[a] : got.on_sides[a]) / got.lateral - 1.0;
    if (std::abs(side) > std::abs(got.misfit[2])) got.misfit[2] = side;
  }
}

}  // namespace

double Outcome::worst() const noexcept {
  return std::max({std::abs(misfit[0]), std::abs(misfit[1]), std::abs(misfit[2])});
}

Outcome measure(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                const neighbor::Neighborhood& neighborhood, const State& state) {
  if (!state.on) return {};
  const dynamics::Law law = dynamics::make_law(scene);
  const auto vertical = static_cast<std::size_t>(scene.container.vertical());
  const Boundary boundary = on_boundary(comm, store, scene, law, neighborhood);
  const Stress stress = of_contacts(comm, store, scene, law, neighborhood);
  const input::Confinement& asked = *scene.in.confinement;
  Outcome got;
  got.on = true;
  got.vertical = asked.on_lid();
  got.lateral = asked.on_sides().value_or(0.0);
  got.tolerance = asked.tolerance;
  got.seconds = static_cast<double>(state.steps) * scene.confining_step;
  got.lid = state.lid;
  got.on_lid = boundary.high[vertical];
  got.on_floor = boundary.low[vertical];
  got.of_contacts.assign(stress.contacts.begin(), stress.contacts.begin() + scene.container.dimension);
  got.vertical_at_rest = stress.vertical_at_rest;
  double lateral = 0.0;
  for (std::size_t a = 0; a < vertical; ++a) {
    lateral += stress.contacts[a] / static_cast<double>(vertical);
    got.size.push_back(scene.container.size[a]);
    got.on_sides.push_back(boundary.high[a]);
  }
  got.ratio = stress.contacts[vertical] > 0.0 ? lateral / stress.contacts[vertical] : 0.0;
  got.phi_before = state.phi_before;
  got.work = state.work;
  got.steps = state.steps;
  judge(scene, got);
  return got;
}

}  // namespace packmpi::confine
