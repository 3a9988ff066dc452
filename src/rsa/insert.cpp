#include "rsa/insert.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/memory.hpp"
#include "rsa/filling.hpp"
#include "rsa/pace.hpp"

namespace packmpi::rsa {
namespace {

std::uint32_t attempt_limit(const scene::Scene& scene) {
  constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(scene.in.layers.attempts, 0, most));
}

// Collective. Throws trials until the class's `unplaced` particles are placed, and adds to `got`. The attempts made, if
// they did not suffice.
std::optional<std::uint32_t> place_class(const comm::Comm& comm, std::int64_t unplaced, std::uint32_t limit,
                                         Filling& filling, particles::Store& store, Insertion& got,
                                         const std::function<void()>& between_volleys) {
  Outlook outlook(limit);
  Pace pace(comm.size());
  for (std::uint32_t attempt = 0; unplaced > 0;) {
    if (attempt == limit || outlook.hopeless(attempt, unplaced)) return attempt;
    if (between_volleys) between_volleys();
    const Volley volley = pace.next(attempt, unplaced, limit);
    const auto [kept, thrown] = filling.fire(volley, store);
    unplaced -= kept;
    const std::int64_t trials = thrown + unplaced * volley.count;
    got.inserted += kept;
    got.trials += trials;
    outlook.record(trials, kept);
    pace.record(trials, kept);
    attempt += volley.count;
  }
  return std::nullopt;
}

std::string advice(const scene::Scene& scene, bool early) {
  const bool alone = insertion_alone(scene.in);
  const char* what = alone && scene.in.particles.count > 0 ? "particles.count" : "layers.fraction";
  const char* room = alone ? "container.size" : "layers.thickness";
  return fmt::format(
      "Lower {} (it saturates near 0.547 for equal discs and 0.384 for equal spheres, and lower in a layer of few "
      "diameters{}), or raise {}{}",
      what, scene.in.layers.gap > 0.0 ? " and with a gap" : "", room, early ? "" : " or layers.attempts");
}

[[noreturn]] void give_up(const comm::Comm& comm, const scene::Scene& scene, const LayerRegion& region,
                          const Insertion& got, int size_class, std::uint32_t attempts) {
  const std::uint32_t limit = attempt_limit(scene);
  const double share =
      got.solid_volume / (scene.container.mean_area(region.bottom, region.thickness) * region.thickness);
  std::string where;
  if (!scene.sizes.equal()) {
    where = fmt::format(" at size class {} of {}, from the largest down", size_class + 1, size_classes);
  }
  const bool early = attempts < limit;
  comm::fail_together(
      comm, ExitCode::bad_input,
      fmt::format("layer {}: random sequential addition placed {} of {} particles: solid fraction {:.4f} of {:.4f}, "
                  "after {} trials; it ended in {} of {} attempts a particle{}{}. {}",
                  region.layer + 1, got.inserted, got.target, share, scene.in.layers.fraction, got.trials, attempts,
                  limit, where, early ? ", as too few of the last trials were accepted" : "", advice(scene, early)));
}

void check_room(const comm::Comm& comm, const scene::Scene& scene, const LayerRegion& region) {
  const double diameter = 2.0 * scene.sizes.largest();
  if (region.thickness >= diameter) return;
  comm::fail_together(comm, ExitCode::bad_input,
                      fmt::format("layers.thickness = {} m is less than the largest particle diameter, {} m",
                                  region.thickness, diameter));
}

// What stopped a layer.
struct Stuck {
  int size_class;
  std::uint32_t attempts;
};

// Collective. The layer's first `asked` particles, class by class; adds to `got`.
std::optional<Stuck> place(const comm::Comm& comm, const scene::Scene& scene, const scene::Ownership& ownership,
                           const LayerRegion& region, std::int64_t asked, particles::Store& store, Insertion& got,
                           const std::function<void()>& between_volleys) {
  Filling filling(comm, scene, ownership, region, asked);
  const Filling::Counts counts = filling.count();
  std::optional<Stuck> stuck;
  for (int k = 0; k < size_classes && !stuck; ++k) {
    filling.begin(k);
    const auto failed = place_class(comm, counts[static_cast<std::size_t>(k)], attempt_limit(scene), filling, store,
                                    got, between_volleys);
    if (failed) stuck = {k, *failed};
  }
  got.solid_volume = filling.solid_volume();
  return stuck;
}

}  // namespace

bool wide_classes(const scene::Sizes& sizes) {
  constexpr double widest = 3.0;  // beyond it, equal differences would leave nearly all small ones in one class
  return sizes.largest() > widest * sizes.smallest();
}

double class_bound(const scene::Sizes& sizes, int k) {
  static_assert(size_classes == 8, "the ratio of a class is the eighth root, by three square roots");
  const double step = std::sqrt(std::sqrt(std::sqrt(sizes.smallest() / sizes.largest())));
  double bound = sizes.largest();
  for (int n = 0; n < k; ++n) bound *= step;
  return bound;
}

int size_class(const scene::Sizes& sizes, double radius) {
  if (wide_classes(sizes)) {
    int k = 0;
    while (k + 1 < size_classes && radius <= class_bound(sizes, k + 1)) ++k;
    return k;
  }
  const double range = sizes.largest() - sizes.smallest();
  if (!(range > 0.0)) return 0;
  return std::clamp(static_cast<int>((sizes.largest() - radius) / range * size_classes), 0, size_classes - 1);
}

Insertion insert(const comm::Comm& comm, const scene::Scene& scene, const scene::Ownership& ownership,
                 const LayerRegion& region, particles::Store& store, const std::function<void()>& between_volleys) {
  const Occupation now("the insertion of a layer");
  check_room(comm, scene, region);
  Insertion got;
  got.target = particles_needed(comm, scene, region);
  const LocalIndex before = store.owned();
  for (std::int64_t asked = got.target;; asked = std::max<std::int64_t>(1, asked * 9 / 10)) {
    got.inserted = 0;
    const auto stuck = place(comm, scene, ownership, region, asked, store, got, between_volleys);
    if (!stuck) return got;
    if (!region.clipped) give_up(comm, scene, region, got, stuck->size_class, stuck->attempts);
    store.keep_first(before);
  }
}

}  // namespace packmpi::rsa
