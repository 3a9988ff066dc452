/// Ghosts: copies of the neighbour ranks' particles near our columns, refreshed in every step.
#pragma once
#include <array>
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

/// The ghosts of a rank by the message they come in: their owner visits its slots in ascending order and sends what
/// lies in the first half of them while it is still busy with the second.
enum class Half : std::size_t { first = 0, second = 1 };
inline constexpr std::array halves = {Half::first, Half::second};

/// A plan made at each rebuild and executed in each step (PetscSF underneath). Ghosts carry their owner's bits,
/// unshifted: periodic images are taken in the pair formula.
class Halo {
 public:
  explicit Halo(const comm::Comm& comm, const particles::Layout& layout);
  ~Halo();
  Halo(const Halo&) = delete;
  Halo& operator=(const Halo&) = delete;

  /// Collective. Sends whole records and ids of `sends` (one entry for each neighbour rank, ascending) and appends what
  /// comes as ghosts, in order of arrival rank. Nothing may be under way. Call order_ghosts() next, then refresh at
  /// will.
  void plan(particles::Store& store, const std::vector<Sends>& sends);

  /// Local, once after plan(). Moves ghost k (arrival order) to slot owned() + place[k].
  void order_ghosts(particles::Store& store, const std::vector<LocalIndex>& place);

  /// Starts to send position, velocity and spin of the owned particles of this half, and to receive those of the ghosts
  /// of this half; the store is only read. All ranks begin and end each half in turn, each half in the order of its
  /// own; work goes on in between. At most one message for each neighbour, counted on the communicator as sent for
  /// ghosts; plan() as for the halo.
  void begin(Half half, const particles::Store& store);
  /// Waits for what begin() started and brings the ghosts of this half up to date. Nothing if nothing is under way.
  void end(Half half, particles::Store& store);
  [[nodiscard]] bool under_way(Half half) const noexcept { return part(half).under_way; }

  /// Collective. A number of each owned particle to its ghosts: values[slot], as long as the store at the last plan().
  /// Entries of slots that are not the halo's stay.
  void share(std::span<std::int64_t> values) const;

  /// Copies of other ranks' particles that are brought up to date.
  [[nodiscard]] LocalIndex ghosts() const noexcept;
  /// The slots of the ghosts of this half.
  [[nodiscard]] std::span<const LocalIndex> ghosts(Half half) const noexcept { return part(half).arrival_slot; }
  /// The owned slots below this one must be done before this half can be sent: one beyond the last that is sent.
  [[nodiscard]] LocalIndex ready(Half half) const noexcept;
  [[nodiscard]] std::size_t bytes() const noexcept;  ///< allocated

 private:
  class Graph;  // a PetscSF
  class Unit;   // the MPI type of a ghost's live doubles
  struct Part {
    std::unique_ptr<Graph> graph;
    std::vector<LocalIndex> send_slot;     // all sends, in rank order: the roots
    std::vector<LocalIndex> arrival_slot;  // slot of the k-th arriving ghost: the leaves
    std::vector<double> send_buffer, receive_buffer;
    std::int64_t messages = 0;  // of a refresh
    bool under_way = false;
  };
  [[nodiscard]] Part& part(Half half) noexcept { return parts_[static_cast<std::size_t>(half)]; }
  [[nodiscard]] const Part& part(Half half) const noexcept { return parts_[static_cast<std::size_t>(half)]; }

  const comm::Comm* comm_;
  particles::Layout layout_;
  std::unique_ptr<Unit> unit_;
  std::array<Part, 2> parts_;
};

}  // namespace packmpi::neighbor
