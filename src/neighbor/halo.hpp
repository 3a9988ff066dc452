/// Ghosts: copies of the neighbour ranks' particles near our columns, refreshed in every step.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "comm/comm.hpp"
#include "particles/store.hpp"
#include "scene/ownership.hpp"

namespace packmpi::neighbor {

/// Which owned particles a neighbour rank needs.
struct Sends {
  Rank rank;
  std::vector<LocalIndex> slots;  ///< ascending
};

/// A plan made at each rebuild and executed in each step (PetscSF underneath). Ghosts carry their owner's bits,
/// unshifted: periodic images are taken in the pair formula.
class Halo {
 public:
  explicit Halo(const comm::Comm& comm, const particles::Layout& layout);
  ~Halo();
  Halo(const Halo&) = delete;
  Halo& operator=(const Halo&) = delete;

  /// Collective. Sends whole records and ids of `sends` (one entry for each neighbour rank, ascending) and appends what
  /// comes as ghosts, in order of arrival rank. Call order_ghosts() next, then refresh() at will.
  void plan(particles::Store& store, std::vector<Sends> sends);

  /// Local. Moves ghost k (arrival order) to slot owned() + place[k].
  void order_ghosts(particles::Store& store, const std::vector<LocalIndex>& place);

  /// Collective. Position, velocity and spin of every ghost from its owner. One message for each neighbour.
  /// Counted on the communicator as sent for ghosts; plan() as for the halo.
  void refresh(particles::Store& store);

  /// Collective. A number of each owned particle to its ghosts: values[slot], as long as the store at the last plan().
  /// Entries of slots that are not the halo's stay.
  void share(std::span<std::int64_t> values) const;

  /// Copies of other ranks' particles that refresh() brings up to date.
  [[nodiscard]] LocalIndex ghosts() const noexcept { return static_cast<LocalIndex>(arrival_slot_.size()); }
  [[nodiscard]] std::size_t bytes() const noexcept;  ///< allocated

 private:
  struct Graph;  // the PetscSF and its unit type
  const comm::Comm* comm_;
  particles::Layout layout_;
  std::unique_ptr<Graph> graph_;
  std::vector<LocalIndex> send_slots_;    // all sends, in rank order: the roots
  std::vector<LocalIndex> arrival_slot_;  // slot of the k-th arriving ghost: the leaves
  std::vector<double> send_buffer_, receive_buffer_;
  std::int64_t messages_per_refresh_ = 0;
};

}  // namespace packmpi::neighbor
