/// The particles of a run and everything that follows them.
#pragma once
#include <cstdint>
#include <vector>

#include "comm/comm.hpp"
#include "dynamics/stepper.hpp"
#include "neighbor/neighborhood.hpp"
#include "observe/measure.hpp"
#include "pack/checkpoint.hpp"
#include "pack/progress.hpp"
#include "particles/store.hpp"
#include "rsa/insert.hpp"
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
  geometry::Container* box = nullptr;      ///< scene.container where it may move, under [confinement]; not owned
  pack::Progress progress;                 ///< frozen particles are in neighborhood.frozen(), not in store
  double stepping = 0.0, inserting = 0.0;  ///< [s] wall time of this rank, since the start or restart

  [[nodiscard]] double time() const;              ///< [s] simulated
  [[nodiscard]] dynamics::Moment moment() const;  ///< now, for messages

  /// Collective. So many steps of the stage that the stepper uses; see there for errors.
  void advance(std::int64_t steps);

  /// Collective. Throws Error(numerical_failure) if any moving particle is as none may be (dynamics::report()).
  void check() { stepper.check(store, neighborhood, moment()); }

  /// Collective. Shares the columns out anew if that pays, and makes the lists.
  void balance();

  /// Freezes all layers but the newest dynamics.window, if there are older ones and a window. Then rebuild. Every rank
  /// alike.
  void freeze_older();
  /// Brings everything frozen back into the store, at rest. Then rebuild. Every rank alike.
  void release();
  /// Takes velocity and spin from every particle, ghosts too; contacts keep what they remember. Local.
  void stop();
  [[nodiscard]] double top() const;      ///< [m] highest top, frozen or not. Collective
  [[nodiscard]] double surface() const;  ///< [m] mean over columns of the highest top, frozen or not. Collective
  [[nodiscard]] double height() const;   ///< [m] of the bed by the scene's rule. Collective

  /// Where the next layer goes: from the highest top, by layers.thickness or to H_d (layers.region). Collective.
  [[nodiscard]] rsa::LayerRegion next_region() const;
  /// True if no layer fits below H_d any more; never with an open region. Collective.
  [[nodiscard]] bool full() const;

  [[nodiscard]] observe::Bulk bulk() const;  ///< by its surface, frozen or not. Collective

  /// What the contacts of this rank's particles remember, frozen or not.
  [[nodiscard]] pack::HistoriesHere histories() const;
  /// Every rank alike. Puts it back: the holders are in the store, and nothing is frozen yet. Then rebuild.
  void give(const pack::Histories& histories);

  /// Solid fraction between two heights of all that lies there, frozen or not. Collective, exact.
  [[nodiscard]] double fraction_of(const control::Slab& slab) const;

  /// Layer of each owned particle, in slot order.
  [[nodiscard]] std::vector<std::int32_t> layers() const;
  /// Stratum of each owned particle, in slot order; empty without strata.
  [[nodiscard]] std::vector<std::int32_t> strata() const;
  /// Gives each owned particle its component's code and mass, by its id. Local.
  void mark_components();
  [[nodiscard]] std::size_t bytes() const noexcept;  ///< allocated for the particles and all about them
  /// Bytes a particle, frozen or not, on the rank where they are most. Collective.
  [[nodiscard]] double bytes_per_particle() const;
};

}  // namespace packmpi::run
