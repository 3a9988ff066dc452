#include <algorithm>
#include <array>
#include <vector>

#include "observe/rest.hpp"
#include "observe/touch.hpp"

namespace packmpi::observe {
namespace {

/// Who holds whom, particles taken away one round after another.
class Holding {
 public:
  Holding(const particles::Store& store, const geometry::Container& box, const neighbor::Neighborhood& neighborhood)
      : neighborhood_(&neighborhood),
        held_(static_cast<std::size_t>(store.total()), 1),
        of_particle_(static_cast<std::size_t>(store.owned())),
        of_walls_(of_particle_.size(), 0) {
    std::size_t pairs = 0;  // or room for twice as many
    each_touching(store, box, neighborhood.pairs(), [&](std::int64_t, LocalIndex, LocalIndex, double) { ++pairs; });
    touching_.reserve(pairs);
    each_touching(store, box, neighborhood.pairs(), [&](std::int64_t, LocalIndex i, LocalIndex j, double) {
      touching_.push_back({i, j});
    });
    each_touching_wall(store, box, neighborhood.walls(),
                       [&](std::int64_t, LocalIndex i, neighbor::Wall, const geometry::Facing&) {
                         ++of_walls_[static_cast<std::size_t>(i)];
                       });
    count();
  }

  /// Owned particles, held and with fewer than `needed` contacts, and contacts of the held ones with each other.
  struct Counts {
    std::int64_t held = 0, loose = 0, contacts = 0;
  };
  [[nodiscard]] Counts counts(int needed) const {
    Counts sums;
    for (std::size_t i = 0; i < of_particle_.size(); ++i) {
      if (held_[i] == 0) continue;
      ++sums.held;
      sums.contacts += of_particle_[i];
      if (is_loose(i, needed)) ++sums.loose;
    }
    return sums;
  }

  /// Collective. Takes the loose ones away.
  void release(int needed) {
    for (std::size_t i = 0; i < of_particle_.size(); ++i) {
      if (held_[i] != 0 && is_loose(i, needed)) held_[i] = 0;
    }
    neighborhood_->share(std::span(held_));
    count();
  }

 private:
  [[nodiscard]] bool is_loose(std::size_t i, int needed) const { return of_particle_[i] + of_walls_[i] < needed; }

  void count() {
    std::ranges::fill(of_particle_, 0);
    for (const auto& [first, second] : touching_) {
      const auto i = static_cast<std::size_t>(first), j = static_cast<std::size_t>(second);
      if (held_[i] == 0 || held_[j] == 0) continue;
      ++of_particle_[i];
      if (j < of_particle_.size()) ++of_particle_[j];
    }
  }

  const neighbor::Neighborhood* neighborhood_;
  std::vector<std::array<LocalIndex, 2>> touching_;   // across a rank border on both ranks, the owned end first
  std::vector<std::int64_t> held_;                    // of owned and ghosts: 0 once taken away
  std::vector<std::int32_t> of_particle_, of_walls_;  // contacts of the owned
};

}  // namespace

Network network(const comm::Comm& comm, const particles::Store& store, const scene::Scene& scene,
                const neighbor::Neighborhood& neighborhood) {
  const int needed = scene.container.dimension + (scene.in.jamming.gravity > 0.0 ? 0 : 1);
  Holding holding(store, scene.container, neighborhood);
  const auto sums = [&] {
    const Holding::Counts mine = holding.counts(needed);
    std::array<std::int64_t, 3> all{mine.held, mine.loose, mine.contacts};
    comm.sum(all);
    return Holding::Counts{all[0], all[1], all[2]};
  };
  Holding::Counts now = sums();
  const auto particles = static_cast<double>(std::max<std::int64_t>(now.held, 1));
  Network result{.coordination = static_cast<double>(now.contacts) / particles,
                 .loose = static_cast<double>(now.loose) / particles};
  while (now.loose > 0) {  // ends: every round takes a particle away
    holding.release(needed);
    now = sums();
  }
  result.rattlers = 1.0 - static_cast<double>(now.held) / particles;
  if (now.held > 0) result.held_coordination = static_cast<double>(now.contacts) / static_cast<double>(now.held);
  return result;
}

}  // namespace packmpi::observe
