/// Who is near whom: migration, memory order, ghosts and Verlet lists of one rank, and when they must be made anew.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "comm/comm.hpp"
#include "mesh/near_memory.hpp"
#include "neighbor/cells.hpp"
#include "neighbor/contact_memory.hpp"
#include "neighbor/frozen.hpp"
#include "neighbor/halo.hpp"
#include "neighbor/lists.hpp"
#include "neighbor/margins.hpp"
#include "neighbor/size_classes.hpp"
#include "neighbor/sweep.hpp"
#include "particles/store.hpp"
#include "scene/ownership.hpp"
#include "scene/scene.hpp"

namespace packmpi::neighbor {

/// What a rank noticed in a step, in order of gravity: nothing; something that is worth a closer look; a state that
/// must not be.
enum class Alarm : int { none = 0, look = 1, fault = 2 };

/// Exact counts of a rank since the beginning, and where its time went.
struct Effort {
  std::int64_t rebuilds = 0;
  std::int64_t candidates = 0;  ///< pairs looked at for contact lists
  double rebuilding = 0.0;      ///< [s] in rebuilds
  double refreshing = 0.0;      ///< [s] sending ghosts, waiting for them, unpacking them; with other ranks only
  double waiting = 0.0;         ///< [s] in the reduction of a step; with other ranks only
};

/// Lists and ghosts of the particles of a store. No result of a run depends on when or how they are built.
class Neighborhood {
 public:
  Neighborhood(const comm::Comm& comm, const scene::Scene& scene, const scene::Ownership& ownership);

  /// Collective. Call after the ownership table changed; then rebuild().
  void ownership_changed();

  /// Every rank alike, without messages. Takes the particles with ids below `below` out of the store; they stand still
  /// with velocity and spin zero, walls to the others, until release(). May be called again with a larger `below`.
  /// Then rebuild().
  void freeze(particles::Store& store, GlobalId below);
  /// Every rank alike, without messages. Gives all frozen particles back to the store, at rest; then rebuild().
  void release(particles::Store& store);
  /// The frozen particles of this rank, owned; their copies from other ranks as ghosts.
  [[nodiscard]] const particles::Store& frozen() const noexcept { return frozen_.store(); }

  /// Collective. Sends particles to the owners of their columns, sorts the owned by cell, gets ghosts, frozen ones too;
  /// makes the lists. Any position is taken, even NaN. Cost: O(owned + ghosts + candidates), three steps at 1:1.
  void rebuild(particles::Store& store);

  /// Collective. Tells that all particles moved for `time_step` at speeds of at most `max_speed` (this rank's own
  /// bound), and what this rank noticed; prepares the next step: rebuilds, or sees to it that the refresh of all ghosts
  /// is under way. Returns on all ranks the gravest alarm of any; a fault too if a speed is not finite, or if particles
  /// are outside the container when lists are due. After a fault nothing is rebuilt.
  [[nodiscard]] Alarm follow(particles::Store& store, double max_speed, double time_step, Alarm mine = Alarm::none);

  /// Every rank alike, without messages; ghosts have arrived. Owned particles and ghosts move with periodic axes whose
  /// lengths become `factors` times what they were, in the container and in the columns: an affine deformation. The
  /// caller changes both.
  void deform(particles::Store& store, const std::array<double, 2>& factors);

  /// Of a mesh: where the walls of the list are now, and what of them each particle touches. Local; rebuild() and
  /// follow() have done it, others that move particles have to. Features of a patch (mesh::Features) whose directions
  /// differ by less than 45 degrees are one wall to a particle: the nearest of them is touched alone, along a mean of
  /// the directions of those that are overlapped, in which what comes and goes has no weight; and it takes over what
  /// the others remember. So a round wall of triangles is touched once wherever its edges are, its force is continuous,
  /// and friction's memory goes with the particle. What depends on positions alone has the same bits whatever the lists
  /// are.
  void face_walls(const particles::Store& store);

  /// Is owned particle `i` where one may be: its centre less than its radius beyond a wall, and finite? Local.
  [[nodiscard]] bool is_inside(const particles::Store& store, LocalIndex i) const;

  /// The legs a step is done in: after each, begin what it sends; before each, end what it needs. See Halo.
  [[nodiscard]] std::span<const Leg> sweep() const noexcept { return sweep_; }
  void begin_refresh(Half half, const particles::Store& store);
  void end_refresh(Half half, particles::Store& store);
  /// Ends what is under way: after it ghosts have the bits of their owners. Collective.
  void arrive(particles::Store& store);
  /// Collective. Both halves begun and ended: for trial states within a step. Nothing may be under way.
  void refresh_ghosts(particles::Store& store);
  /// Collective. A number of each owned particle to its ghosts, by slot; see Halo::share.
  void share(std::span<std::int64_t> values) const { halo_.share(values); }

  [[nodiscard]] const PairList& pairs() const noexcept { return pairs_; }
  [[nodiscard]] const PairList& near_pairs() const noexcept { return near_pairs_; }  ///< near field; empty when off
  [[nodiscard]] const WallList& walls() const noexcept { return walls_; }
  [[nodiscard]] const Halo& halo() const noexcept { return halo_; }

  /// What the contacts remember, beside pairs() and walls(); a step replaces it.
  [[nodiscard]] ContactMemory& memory() noexcept { return memory_; }
  [[nodiscard]] const ContactMemory& memory() const noexcept { return memory_; }
  /// Calls see() once on one rank for each contact that remembers something, frozen ones too: on the owner of
  /// ContactHistory::holder(). In no particular order. Local.
  void each_history(const particles::Store& store, const std::function<void(const ContactHistory&)>& see) const;
  /// Every rank alike, without messages. Puts back what each_history() told, wherever the particles are now: each rank
  /// gives what the holders in its store have (the others are passed over). Before freeze() and rebuild(), after which
  /// all ranks have their copies.
  void give(const particles::Store& store, std::span<const ContactHistory> histories);
  /// Pairs of particles looked at for the contact lists in the last rebuild.
  [[nodiscard]] std::int64_t candidates() const noexcept { return candidates_; }
  [[nodiscard]] std::int64_t rebuilds() const noexcept { return effort_.rebuilds; }
  [[nodiscard]] const Effort& effort() const noexcept { return effort_; }
  [[nodiscard]] std::size_t bytes() const noexcept;  ///< allocated

  /// Moving particles in each own column, in the order of Ownership::columns(); the weights of the balance. Local.
  [[nodiscard]] std::vector<std::int64_t> column_counts(const particles::Store& store) const;

 private:
  [[nodiscard]] std::vector<Rank> destinations(const particles::Store& store) const;
  void migrate(particles::Store& store, std::span<const Rank> destination, Baggage* baggage,
               comm::Purpose purpose) const;  // collective
  void complete_borders(const particles::Store& store);
  void begin_missing(const particles::Store& store);  // collective
  void meet(std::array<double, 2>& shared);           // collective: the reduction of a step
  void sort_owned(particles::Store& store);
  [[nodiscard]] std::vector<Sends> choose_sends(const particles::Store& store) const;
  void sort_ghosts(particles::Store& store);
  void add_frozen(particles::Store& store);
  void remember_positions(const particles::Store& store);
  struct Run {
    LocalIndex begin, end;  // slots
  };
  void find_runs(int c, std::size_t k, std::vector<Run>& runs) const;
  void build_pairs(const particles::Store& store, std::optional<double> cutoff, PairList& list);
  void build_walls(const particles::Store& store);
  void build_features(const particles::Store& store, double lid_moves);
  [[nodiscard]] double least_slack(const particles::Store& store) const;  // this rank's [m]

  const comm::Comm* comm_;
  const scene::Scene* scene_;
  const scene::Ownership* ownership_;
  LocalColumns columns_;
  Cells cells_;
  Frozen frozen_;
  Cells frozen_cells_;           // slots of the frozen particles among the ghosts; empty while there are none
  bool frozen_arranged_ = true;  // by the present owners
  Halo halo_;
  SizeClasses size_classes_;  // used if the scene has more than one
  PairList pairs_, near_pairs_;
  WallList walls_;
  mesh::NearMemory near_memory_;  // of a mesh
  ContactMemory memory_;
  bool one_sided_ = false;  // histories of border pairs may be at one of their owners only, on some rank
  std::vector<Leg> sweep_;
  // Positions at the last rebuild, of owned and ghosts, one array an axis, and how far lists reach from there.
  std::array<std::vector<double>, 3> x_;
  std::vector<double> extent_;
  Margins margins_;
  double time_step_ = 0.0;       // the last [s]
  double slack_ = 0.0;           // what any particle could still move when it was looked at, this rank [m]
  double drift_ = 0.0;           // bound of any displacement since then, this rank [m]
  double strained_ = 0.0;        // what deformation has added since then, the same on all ranks [m]
  std::int64_t candidates_ = 0;  // in the last rebuild
  Effort effort_;
};

}  // namespace packmpi::neighbor
