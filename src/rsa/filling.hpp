/// A layer while it fills.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "comm/comm.hpp"
#include "comm/exact_sum.hpp"
#include "particles/store.hpp"
#include "rsa/border.hpp"
#include "rsa/cells.hpp"
#include "rsa/conflicts.hpp"
#include "rsa/insert.hpp"
#include "rsa/mail.hpp"
#include "rsa/placed.hpp"
#include "rsa/sampler.hpp"

namespace packmpi::rsa {

/// The spheres placed in this rank's columns and the particles whose next trials this rank throws. Memory: O(asked /
/// ranks).
class Filling {
 public:
  /// Local. The rank starts with an equal share of the `asked` particles, by index.
  Filling(const comm::Comm& comm, const scene::Scene& scene, const scene::Ownership& ownership,
          const LayerRegion& region, std::int64_t asked);

  using Counts = std::array<std::int64_t, size_classes>;
  /// Collective. Particles of each size class in the layer.
  [[nodiscard]] Counts count() const;
  /// Local. The particles of a size class come next; none may be waiting.
  void begin(int size_class);
  /// Collective. Throws the volley's trials for every particle that waits and appends the spheres that stay.
  Conflicts::Outcome fire(const Volley& volley, particles::Store& store);
  /// Collective. Of all spheres placed [m3], 2D: [m2].
  [[nodiscard]] double solid_volume() const { return comm::exact_sum(comm_, volume_); }

 private:
  struct Waiting {
    std::uint64_t particle;
    double radius;
  };
  [[nodiscard]] std::vector<Trial> make_trials(const Volley& volley);
  void append(const Trial& trial, particles::Store& store);
  void wait(const Trial& trial) { waiting_.push_back({trial.particle, trial.sphere.radius}); }

  const comm::Comm& comm_;
  const scene::Scene& scene_;
  LayerRegion region_;
  Sampler sampler_;
  CellGrids grid_;
  Border border_;
  Placed placed_;  // of this layer, in this rank's columns and near them
  Conflicts conflicts_;
  Mailbox<Trial> mail_;
  std::array<std::vector<Waiting>, size_classes> share_;  // the classes to come
  std::vector<Waiting> waiting_;                          // of the present class
  std::vector<char> is_free_;                             // of each trial of a volley
  std::vector<Trial> free_;  // trials that overlap none placed before their volley, in order
  comm::ExactSum volume_;    // of the spheres placed here
};

}  // namespace packmpi::rsa
