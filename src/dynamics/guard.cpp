#include "dynamics/guard.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "base/elementary.hpp"
#include "dynamics/kernel.hpp"
#include "geometry/container.hpp"
#include "input/time_step.hpp"
#include "scene/limits.hpp"

namespace packmpi::dynamics {
namespace {

constexpr std::size_t most_named = 6;   // neighbours in a message
constexpr double modest_overlap = 0.1;  // to be had from the modulus that a message suggests

bool is_finite(const particles::Store& store, LocalIndex i) {
  const double sum = norm(store.position(i)) + norm(store.velocity(i)) + norm(store.spin(i)) + store.radius(i);
  return std::isfinite(sum);
}

/// Overlap of a listed pair over the smaller radius; negative: apart.
double overlap_of(const Inspected& now, LocalIndex i, LocalIndex j) {
  const Vec3 d = geometry::separation(now.scene.container, now.store.position(i), now.store.position(j));
  const double ri = now.store.radius(i);
  const double rj = now.store.radius(j);
  return (ri + rj - norm(d)) / std::min(ri, rj);
}

/// Penetration of the wall of an entry over the radius; negative: apart.
double penetration_of(const Inspected& now, LocalIndex i, std::size_t entry) {
  const double distance =
      neighbor::facing_of(now.scene.container, now.neighborhood.walls(), entry, now.store.position(i)).distance;
  return (now.store.radius(i) - distance) / now.store.radius(i);
}

/// Keeps the worst of what it is shown.
class Worst {
 public:
  explicit Worst(const particles::Store& store) : store_(store) {}
  void show(Fault fault, double size, LocalIndex slot) {
    if (fault < worst_.fault || (fault == worst_.fault && size < worst_.size)) return;
    const auto id = [&](LocalIndex i) { return store_.ids()[static_cast<std::size_t>(i)]; };
    if (fault == worst_.fault && size == worst_.size && id(slot) > id(worst_.slot)) return;
    worst_ = {fault, size, slot};
  }
  [[nodiscard]] const Finding& finding() const { return worst_; }

 private:
  const particles::Store& store_;
  Finding worst_;
};

void inspect_contacts(const Inspected& now, Worst& worst) {
  const neighbor::PairList& pairs = now.neighborhood.pairs();
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    const double overlap = overlap_of(now, pairs.first[p], pairs.second[p]);
    if (!(overlap > deepest_overlap)) continue;
    worst.show(Fault::overlap, overlap, pairs.first[p]);
    if (pairs.second[p] < now.store.owned()) worst.show(Fault::overlap, overlap, pairs.second[p]);
  }
  const neighbor::WallList& walls = now.neighborhood.walls();
  for (std::size_t w = 0; w < walls.particle.size(); ++w) {
    const double depth = penetration_of(now, walls.particle[w], w);
    if (depth > deepest_overlap) worst.show(Fault::overlap, depth, walls.particle[w]);
  }
}

/// The fastest owned particle, under the name of a fault that has no place.
Finding fastest(const particles::Store& store, Fault fault) {
  Worst worst(store);
  for (LocalIndex i = 0; i < store.owned(); ++i) worst.show(fault, norm(store.velocity(i)), i);
  return worst.finding();
}

/// What touches a particle, as words: the deepest first.
std::string neighbors_of(const Inspected& now, LocalIndex i) {
  std::vector<std::pair<double, std::string>> touching;
  const neighbor::PairList& pairs = now.neighborhood.pairs();
  for (std::size_t p = 0; p < pairs.first.size(); ++p) {
    if (pairs.first[p] != i && pairs.second[p] != i) continue;
    const LocalIndex other = pairs.first[p] == i ? pairs.second[p] : pairs.first[p];
    const double overlap = overlap_of(now, i, other);
    if (overlap > 0.0) {
      touching.emplace_back(-overlap, fmt::format("{}", now.store.ids()[static_cast<std::size_t>(other)]));
    }
  }
  constexpr std::array<const char*, geometry::most_surfaces> names{
      "the floor", "the wall x = 0", "the wall x = L", "the wall y = 0",         "the wall y = B",
      "the lid",   "the round wall", "the inner wall", "the wall above the cone"};
  const neighbor::WallList& walls = now.neighborhood.walls();
  for (std::size_t w = 0; w < walls.particle.size(); ++w) {
    const double depth = walls.particle[w] == i ? penetration_of(now, i, w) : 0.0;
    if (!(depth > 0.0)) continue;
    const auto number = static_cast<std::size_t>(walls.wall[w]);
    touching.emplace_back(-depth, number < names.size()
                                      ? names.at(number)
                                      : fmt::format("part {} of the {}", number - names.size(),
                                                    now.scene.container.is_mesh() ? "mesh" : "polygon"));
  }
  if (touching.empty()) return "touches nothing";
  std::ranges::sort(touching);
  std::string words = "touches ";
  for (std::size_t k = 0; k < std::min(touching.size(), most_named); ++k) {
    words += fmt::format("{}{} (overlap {:.2g} r)", k == 0 ? "" : ", ", touching[k].second, -touching[k].first);
  }
  if (touching.size() > most_named) words += fmt::format(" and {} more", touching.size() - most_named);
  return words;
}

std::string what_of(const Inspected& now, const Finding& found, GlobalId id) {
  switch (found.fault) {
    case Fault::overlap:
      return fmt::format("particle {} overlaps another or a wall by {:.2g} of the smaller radius, beyond {:g} of it",
                         id, found.size, deepest_overlap);
    case Fault::speed:
      return fmt::format("particle {} is faster than this scene can make it: {:.3g} m/s, beyond {:.3g} m/s", id,
                         found.size, speed_limit(now.scene, now.stage));
    case Fault::outside:
      return fmt::format("particle {} left the container", id);
    case Fault::not_finite:
      return fmt::format("particle {} has numbers that are not finite", id);
    default:
      return fmt::format("a force is beyond {:.2g} N, the range of the sums; the fastest particle, {}",
                         max_quanta * now.scene.force_quantum, id);
  }
}

/// What to change, with numbers: the step to the limit of eq. (23) at the particle's own speed, or to half of itself if
/// it is below; and what is pressed too far at a step that is small enough wants a harder material.
std::string advice(const Inspected& now, const Finding& found) {
  const input::Input& in = now.scene.in;
  const bool settling = in.layers.time_step && now.stage.time_step == now.scene.settling.time_step;
  const double speed = norm(now.store.velocity(found.slot));
  const double known = std::isfinite(speed) ? speed : now.scene.speed_bound;
  const double limit = input::step_limit(in, now.store.radius(found.slot), now.stage.youngs_modulus, known);
  std::string words = fmt::format("use {} = {:.2g} s or less (eq. (23) gives {:.2g} s at {:.3g} m/s)",
                                  settling ? "layers.time_step" : "dynamics.time_step",
                                  std::min(limit, 0.5 * now.stage.time_step), limit, known);
  const bool pressed = found.fault == Fault::overlap || found.fault == Fault::outside;
  if (!pressed || limit < now.stage.time_step) return words;
  const double overlap = found.fault == Fault::overlap ? std::max(found.size, 1.0) : 1.0;  // still growing
  const double stiffer =
      now.stage.youngs_modulus * elementary::power(overlap / modest_overlap, 2.5);  // an impact's exponent
  return words + fmt::format(", or {} = {:.1e} Pa or more",
                             in.layers.youngs_modulus ? "layers.youngs_modulus" : "particles.youngs_modulus", stiffer);
}

std::string message(const Inspected& now, const Moment& moment, const Finding& found) {
  const LocalIndex i = found.slot;
  const Vec3 x = now.store.position(i);
  const Vec3 v = now.store.velocity(i);
  return fmt::format(
      "layer {}, step {}, {:g} s: {}: position ({:g}, {:g}, {:g}) m, velocity ({:g}, {:g}, {:g}) m/s, radius {:g} m, "
      "on "
      "rank {}; it {}; {}",
      moment.layer, moment.step, moment.time, what_of(now, found, now.store.ids()[static_cast<std::size_t>(i)]), x[0],
      x[1], x[2], v[0], v[1], v[2], now.store.radius(i), now.comm.rank(), neighbors_of(now, i), advice(now, found));
}

}  // namespace

double speed_limit(const scene::Scene& scene, const scene::Stage& stage) {
  if (scene.in.dynamics.theta > 0.0) return scene.speed_bound;  // implicit steps are halved where that is too far
  return std::min(scene.speed_bound, 0.5 * scene.sizes.smallest() / stage.time_step);
}

Finding inspect(const Inspected& now) {
  Worst worst(now.store);
  const double limit = speed_limit(now.scene, now.stage);
  for (LocalIndex i = 0; i < now.store.owned(); ++i) {
    const double speed = norm(now.store.velocity(i));
    if (!is_finite(now.store, i)) {
      worst.show(Fault::not_finite, 0.0, i);
    } else if (!now.neighborhood.is_inside(now.store, i)) {
      worst.show(Fault::outside, 0.0, i);
    } else if (speed > limit) {
      worst.show(Fault::speed, speed, i);
    }
  }
  inspect_contacts(now, worst);
  return worst.finding();
}

void report(const Inspected& now, const Moment& moment) {
  Finding found = inspect(now);
  auto gravest = static_cast<Fault>(now.comm.max(static_cast<std::int64_t>(found.fault)));
  if (gravest == Fault::none) {
    gravest = Fault::force;  // nothing else raises an alarm; the forces themselves are gone
    found = fastest(now.store, gravest);
  }
  constexpr GlobalId nobody = std::numeric_limits<GlobalId>::max();
  const double size = now.comm.max(found.fault == gravest ? found.size : -HUGE_VAL);
  const bool worst = found.fault == gravest && found.size == size;
  const GlobalId id = worst ? now.store.ids()[static_cast<std::size_t>(found.slot)] : nobody;
  std::optional<std::string> words;
  if (now.comm.min(id) == id && worst) words = message(now, moment, found);
  comm::agree(now.comm, ExitCode::numerical_failure, words);
  throw Error(ExitCode::numerical_failure, "a numerical failure without a particle");  // not reached: one has words
}

}  // namespace packmpi::dynamics
