#include "rsa/filling.hpp"

#include <algorithm>
#include <utility>

#include "geometry/volume.hpp"
#include "scene/mixture.hpp"

namespace packmpi::rsa {

Filling::Filling(const comm::Comm& comm, const scene::Scene& scene, const scene::Ownership& ownership,
                 const LayerRegion& region, std::int64_t asked)
    : comm_(comm),
      scene_(scene),
      region_(region),
      sampler_(scene, ownership, region),
      grid_(scene, ownership, region, asked),
      border_(ownership, comm.rank(), scene.sizes.largest() + scene.in.layers.gap),
      placed_(Bins(grid_, Metric(scene.container, scene.in.layers.gap)), Excluded(scene, ownership, region, asked)),
      conflicts_(comm, grid_, Metric(scene.container, scene.in.layers.gap), border_, sampler_, placed_) {
  const auto bound = [&](std::int64_t rank) {
    return asked / comm.size() * rank + std::min(rank, asked % comm.size());
  };
  for (std::int64_t k = bound(comm.rank()); k < bound(comm.rank() + 1); ++k) {
    const auto particle = static_cast<std::uint64_t>(k);
    const double radius = drawn(scene, region, particle).radius;
    share_[static_cast<std::size_t>(size_class(scene.sizes, radius))].push_back({particle, radius});
  }
}

Filling::Counts Filling::count() const {
  Counts counts{};
  for (std::size_t k = 0; k < counts.size(); ++k) counts[k] = static_cast<std::int64_t>(share_[k].size());
  comm_.sum(counts);
  return counts;
}

void Filling::begin(int size_class) { waiting_ = std::exchange(share_[static_cast<std::size_t>(size_class)], {}); }

Conflicts::Outcome Filling::fire(const Volley& volley, particles::Store& store) {
  const std::vector<Trial> trials = make_trials(volley);
  waiting_.clear();
  free_.clear();
  placed_.find_free(trials, is_free_);
  for (std::size_t k = 0; k < trials.size(); ++k) {
    const Trial& trial = trials[k];
    if (is_free_[k] != 0) {
      free_.push_back(trial);
    } else if (trial.attempt == volley.last()) {  // the particle goes on from the rank where its last trial fell
      wait(trial);
    }
  }
  std::ranges::sort(free_, {}, turn);
  const Conflicts::Outcome outcome = conflicts_.resolve(free_, volley);
  for (std::size_t k = 0; k < free_.size(); ++k) {
    if (conflicts_.kept(k)) {
      append(free_[k], store);
    } else if (free_[k].attempt == volley.last()) {
      wait(free_[k]);
    }
  }
  std::erase_if(waiting_, [&](const Waiting& left) { return conflicts_.placed_earlier(left.particle); });
  return outcome;
}

// The volley's trials that fall in this rank's columns, whoever threw them.
std::vector<Trial> Filling::make_trials(const Volley& volley) {
  std::vector<Trial> mine;
  mine.reserve(waiting_.size() * volley.count);
  for (const auto& [particle, radius] : waiting_) {
    for (std::uint32_t attempt = volley.first; attempt <= volley.last(); ++attempt) {
      const Trial trial = sampler_.trial(particle, radius, attempt);
      const Rank owner = sampler_.owner(trial);
      if (owner == comm_.rank()) {
        mine.push_back(trial);
      } else {
        mail_.post(owner, trial);
      }
    }
  }
  const std::vector<Trial> received = mail_.deliver(comm_);
  mine.insert(mine.end(), received.begin(), received.end());
  return mine;
}

void Filling::append(const Trial& trial, particles::Store& store) {
  const auto& [centre, radius] = trial.sphere;
  const input::Layers& layers = scene_.in.layers;
  particles::Substance made_of;
  if (scene_.features.mixture)
    made_of = scene::substance_of(scene_.in, drawn(scene_, region_, trial.particle).component, radius);
  store.add(region_.first_id + static_cast<GlobalId>(trial.particle), centre, radius, layers.velocity, layers.spin,
            made_of);
  volume_.add(geometry::volume(scene_.container.dimension, radius));
}

}  // namespace packmpi::rsa
