#include "rsa/filling.hpp"

#include <algorithm>
#include <utility>

#include "geometry/volume.hpp"

namespace packmpi::rsa {

Filling::Filling(const comm::Comm& comm, const scene::Scene& scene, const scene::Ownership& ownership,
                 const LayerRegion& region, std::int64_t asked)
    : comm_(comm),
      scene_(scene),
      region_(region),
      thrower_(scene, ownership, region),
      grid_(scene, ownership, region, asked),
      border_(ownership, comm.rank(), scene.sizes.largest()),
      placed_(grid_, Metric(scene.box)),
      conflicts_(comm, grid_, Metric(scene.box), border_, thrower_, placed_) {
  const auto bound = [&](std::int64_t rank) {
    return asked / comm.size() * rank + std::min(rank, asked % comm.size());
  };
  for (std::int64_t k = bound(comm.rank()); k < bound(comm.rank() + 1); ++k) {
    const auto particle = static_cast<std::uint64_t>(k);
    const double radius = scene.sizes.draw(region.layer, particle);
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
  const std::vector<Dart> darts = throw_darts(volley);
  waiting_.clear();
  free_.clear();
  for (const Dart& dart : darts) {
    if (!placed_.overlaps(dart.sphere)) {
      free_.push_back(dart);
    } else if (dart.attempt == volley.last()) {  // the particle goes on from the rank where its last dart fell
      wait(dart);
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

// The volley's darts that fall in this rank's columns, whoever threw them.
std::vector<Dart> Filling::throw_darts(const Volley& volley) {
  std::vector<Dart> mine;
  mine.reserve(waiting_.size() * volley.count);
  for (const auto& [particle, radius] : waiting_) {
    for (std::uint32_t attempt = volley.first; attempt <= volley.last(); ++attempt) {
      const Dart dart = thrower_.dart(particle, radius, attempt);
      const Rank owner = thrower_.owner(dart);
      if (owner == comm_.rank()) {
        mine.push_back(dart);
      } else {
        mail_.post(owner, dart);
      }
    }
  }
  const std::vector<Dart> received = mail_.deliver(comm_);
  mine.insert(mine.end(), received.begin(), received.end());
  return mine;
}

void Filling::append(const Dart& dart, particles::Store& store) {
  const auto& [centre, radius] = dart.sphere;
  const input::Layers& layers = scene_.in.layers;
  store.add(region_.first_id + static_cast<GlobalId>(dart.particle), centre, radius, layers.velocity, layers.spin);
  volumes_.push_back(geometry::volume(scene_.box.dimension, radius));
}

}  // namespace packmpi::rsa
