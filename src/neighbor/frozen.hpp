/// Particles that stand still for the while: kept aside, and walls to the moving ones near them.
#pragma once
#include <vector>

#include "comm/comm.hpp"
#include "neighbor/baggage.hpp"
#include "neighbor/cells.hpp"
#include "particles/store.hpp"
#include "scene/ownership.hpp"

namespace packmpi::neighbor {

/// The frozen particles of a rank's columns and copies of those in the ghost columns within reach of its own, both in
/// the order of (local column, height). They are not integrated, binned, listed or exchanged; at each rebuild those
/// that a moving particle of the same or a touching column may reach enter its store as ghosts that are never
/// refreshed. Which particles are frozen is a matter of their ids, so nothing here depends on the ranks.
class Frozen {
 public:
  /// `doubles` stored for each contact.
  Frozen(const comm::Comm& comm, const particles::Layout& layout, int doubles)
      : comm_(&comm), store_(layout), baggage_(doubles) {}

  /// Local, but on every rank alike. Moves the owned particles of `from` with ids below `below` here and sets their
  /// velocities and spins to zero. Drops the ghosts of `from`. Then arrange(). `contacts` (null: none are remembered)
  /// are those of the particles of `from`: what both ends of are frozen comes along, and is kept until give_back.
  void take(particles::Store& from, GlobalId below, Baggage* contacts);
  /// Local, but on every rank alike. Moves all of them back, at rest; drops the ghosts of `to`.
  void give_back(particles::Store& to, Baggage* contacts);
  /// Is there anything, on any rank? The same on every rank.
  [[nodiscard]] bool in_use() const noexcept { return in_use_; }
  /// Frozen particles of this rank: owned in the order of columns, then the copies as ghosts.
  [[nodiscard]] const particles::Store& store() const noexcept { return store_; }
  [[nodiscard]] particles::Store& store() noexcept { return store_; }
  /// Contacts of the frozen among themselves and with walls.
  [[nodiscard]] const Baggage& baggage() const noexcept { return baggage_; }
  [[nodiscard]] Baggage& baggage() noexcept { return baggage_; }

  /// Collective. Once the particles are with the owners of their columns: sorts them and gets the copies of those
  /// within `range` [m] of our columns. Cost: O(frozen particles of the rank); once for each freeze or change of
  /// owners.
  void arrange(const scene::Ownership& ownership, const LocalColumns& columns, double range);

  /// Local. Appends to the ghosts of `moving` the particles not lower than lowest[c] [m] in each local column c, and
  /// puts their slots into `cells`, whose levels are set. Cost: O(columns + particles appended).
  void append(const std::vector<double>& lowest, particles::Store& moving, Cells& cells) const;

 private:
  void sort(const scene::Ownership& ownership, const LocalColumns& columns);
  [[nodiscard]] std::vector<comm::Parcel> copies(const scene::Ownership& ownership, const LocalColumns& columns,
                                                 double range) const;
  void add_copies(const std::vector<comm::Parcel>& parcels, const scene::Ownership& ownership,
                  const LocalColumns& columns);
  [[nodiscard]] double height(LocalIndex i) const noexcept { return store_.record(i)[store_.layout().dimension - 1]; }

  const comm::Comm* comm_;
  particles::Store store_;
  Baggage baggage_;
  std::vector<LocalIndex> start_;  // slots of local column c: start_[c] .. start_[c + 1), ascending in height
  bool in_use_ = false;
};

}  // namespace packmpi::neighbor
