/// The particles of a run and everything that follows them.
#pragma once
#include <cstdint>
#include <vector>

#include "comm/comm.hpp"
#include "dynamics/stepper.hpp"
#include "neighbor/neighborhood.hpp"
#include "particles/store.hpp"
#include "scene/ownership.hpp"
#include "scene/scene.hpp"

namespace packmpi::run {

/// State of a run on this rank. The scene and the communicator must outlive it.
struct Bed {
  Bed(const comm::Comm& world, const scene::Scene& what);

  const comm::Comm& comm;
  const scene::Scene& scene;
  scene::Ownership ownership;
  particles::Store store;
  neighbor::Neighborhood neighborhood;
  dynamics::Stepper stepper;
  std::vector<GlobalId> first_ids;  ///< of each layer
  GlobalId moving_from = 0;         ///< particles with smaller ids are frozen: in neighborhood.frozen(), not in store
  GlobalId count = 0;               ///< particles on all ranks
  /// [J] kinetic and potential, as the moving particles were given it: at insertion, less what the frozen took away
  double energy_given = 0.0;
  std::int64_t steps = 0;
  std::int64_t relaxation_steps = 0;        ///< of them, in final relaxations
  std::int64_t earlier_particle_steps = 0;  ///< on all ranks, before a restart
  double stepping = 0.0, inserting = 0.0;   ///< [s] wall time of this rank, since the start or restart

  [[nodiscard]] double time() const;                  ///< [s] simulated
  [[nodiscard]] dynamics::Moment moment() const;      ///< now, for messages
  [[nodiscard]] std::int64_t particle_steps() const;  ///< since the beginning, on all ranks. Collective

  /// Collective. Throws Error(numerical_failure) if any moving particle is as none may be (dynamics::report()).
  void check() { stepper.check(store, neighborhood, moment()); }

  /// Collective. Shares the columns out anew if that pays, and makes the lists.
  void balance();

  /// Freezes all layers but the newest dynamics.window, if there are older ones and a window. Then rebuild. Every rank
  /// alike.
  void freeze_older();
  /// Brings everything frozen back into the store, at rest. Then rebuild. Every rank alike.
  void release();
  [[nodiscard]] double top() const;     ///< [m] highest top, frozen or not. Collective
  [[nodiscard]] double height() const;  ///< [m] of the bed by the scene's rule. Collective

  /// Layer of each owned particle, in slot order.
  [[nodiscard]] std::vector<std::int32_t> layers() const;
  [[nodiscard]] std::size_t bytes() const noexcept;  ///< allocated for the particles and all about them
  /// Bytes a particle, frozen or not, on the rank where they are most. Collective.
  [[nodiscard]] double bytes_per_particle() const;
};

}  // namespace packmpi::run
