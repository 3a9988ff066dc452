/// What the contacts of a rank's particles remember (scene::storings), beside the lists a step reads, and how it stays
/// with them.
///
/// Each rank that owns an end of a pair keeps the pair's stored doubles and computes them anew from the same operands,
/// so that the copies agree to the bit without messages. At a rebuild they go from the old lists to the new ones by the
/// ids of both ends, on the way with the particle that holds them (Baggage).
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "neighbor/baggage.hpp"
#include "neighbor/lists.hpp"
#include "particles/store.hpp"
#include "scene/features.hpp"

namespace packmpi::neighbor {

/// One contact as the outside sees it, once: oriented from `first` to `second`.
struct ContactHistory {
  GlobalId first;                  ///< the lower id; of a wall: the particle
  GlobalId second;                 ///< the higher id; of a wall: -1 - its number (see Wall)
  std::span<const double> values;  ///< scene::stored_doubles of them, in the order of scene::storings

  /// The particle at whose owner the contact is seen, and has to be given back.
  [[nodiscard]] GlobalId holder() const noexcept { return second < 0 ? first : second; }
};

/// The partner that stands for a wall.
[[nodiscard]] constexpr GlobalId wall_partner(Wall wall) noexcept { return -1 - static_cast<GlobalId>(wall); }

/// Beside pair and wall lists: `doubles` arrays as long as the list, one after the other.
class ContactMemory {
 public:
  explicit ContactMemory(const scene::Features& features);

  /// Does this scene's law store anything? If not, every other call does nothing.
  [[nodiscard]] bool in_use() const noexcept { return doubles_ > 0; }
  [[nodiscard]] std::size_t doubles() const noexcept { return doubles_; }

  // What a step reads and writes: double c of entry p at [c * length of the list + p].
  [[nodiscard]] double* of_pairs() noexcept { return pair_values_.data(); }
  [[nodiscard]] double* of_walls() noexcept { return wall_values_.data(); }
  [[nodiscard]] const double* of_pairs() const noexcept { return pair_values_.data(); }
  [[nodiscard]] const double* of_walls() const noexcept { return wall_values_.data(); }

  /// From the lists, which were built for `store` as it is (particles may have been appended and ghosts dropped), into
  /// the baggage, unless it is there. Two particles' contact is held by the first, whose items then lie together.
  /// `destination`: the rank each owned particle is about to go to, empty if all stay; a pair that parts is held by
  /// both.
  void pick_up(const particles::Store& store, const PairList& pairs, const WallList& walls,
               std::span<const Rank> destination = {});
  /// The same, held by the higher id.
  void pick_up_by_id(const particles::Store& store, const PairList& pairs, const WallList& walls);
  /// From the baggage to new lists.
  void lay_down(const particles::Store& store, const PairList& pairs, const WallList& walls);

  /// Only between pick_up and lay_down; follows the store's particles.
  [[nodiscard]] Baggage& baggage() noexcept { return baggage_; }

  /// Puts what this rank's store holds of `histories` into the baggage; see Neighborhood::give.
  void give(const particles::Store& store, std::span<const ContactHistory> histories);
  /// Calls see() for each contact that this rank's particles hold, not zero, in no particular order.
  void each(const particles::Store& store, const PairList& pairs, const WallList& walls,
            const std::function<void(const ContactHistory&)>& see) const;
  /// The same of a store whose contacts are in `baggage`.
  void each(const particles::Store& store, const Baggage& baggage,
            const std::function<void(const ContactHistory&)>& see) const;

  /// Appends to `out` the contacts of owned particles with ghosts (below slot `end`), as the ghost's owner sees them:
  /// see(ghost slot, ghost id, own id, values).
  using Border = std::function<void(LocalIndex, GlobalId, GlobalId, std::span<const double>)>;
  void each_border(const particles::Store& store, const PairList& pairs, LocalIndex end, const Border& see) const;
  /// Sets the contact of owned particle `mine` with the ghost `other`, if it is listed.
  void set_border(const particles::Store& store, const PairList& pairs, LocalIndex mine, GlobalId other,
                  const double* values);

  [[nodiscard]] std::size_t bytes() const noexcept {  ///< allocated
    return (pair_values_.capacity() + wall_values_.capacity()) * sizeof(double) +
           ghost_ids_.capacity() * sizeof(GlobalId);
  }

 private:
  [[nodiscard]] GlobalId id_of(const particles::Store& store, LocalIndex slot) const noexcept {
    return slot < owned_ ? store.ids()[static_cast<std::size_t>(slot)]
                         : ghost_ids_[static_cast<std::size_t>(slot - owned_)];
  }
  void begin_pick_up(LocalIndex owned);
  void end_pick_up(const WallList& walls);
  [[nodiscard]] bool is_zero(const std::vector<double>& values, std::size_t entries, std::size_t entry) const noexcept;

  std::size_t doubles_;
  std::vector<double> signs_;     // of each double, when the ends are exchanged
  std::vector<double> the_same_;  // ones
  std::vector<double> pair_values_, wall_values_;
  LocalIndex owned_ = 0;             // when the lists were laid down
  std::vector<GlobalId> ghost_ids_;  // likewise: the store drops its ghosts before we are asked
  bool listed_ = false;              // in the lists; else in the baggage
  Baggage baggage_;
};

}  // namespace packmpi::neighbor
