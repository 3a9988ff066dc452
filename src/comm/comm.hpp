/// A communicator and the collectives the other modules need, on spans and values; no raw MPI elsewhere.
/// Every function that says "collective" is called by all ranks in the same order.
#pragma once
#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.hpp"
#include "base/types.hpp"
#include "comm/traffic.hpp"

namespace packmpi::comm {

/// A block of bytes and the rank it goes to or came from.
struct Parcel {
  Rank rank;
  std::vector<std::byte> bytes;
};

/// A duplicate of a communicator, owned; moved, never copied. Construction is collective.
/// MPI errors abort the job with MPI's text (MPI_ERRORS_ARE_FATAL): a broken network is not recoverable here.
class Comm {
 public:
  explicit Comm(MPI_Comm parent);
  ~Comm();
  Comm(Comm&& other) noexcept;
  Comm& operator=(Comm&&) = delete;
  Comm(const Comm&) = delete;
  Comm& operator=(const Comm&) = delete;

  /// Collective. The communicator of those ranks that give the same `color` (>= 0), in the order of their ranks here.
  [[nodiscard]] Comm split(int color) const;

  [[nodiscard]] Rank rank() const noexcept { return rank_; }
  [[nodiscard]] int size() const noexcept { return size_; }
  [[nodiscard]] MPI_Comm handle() const noexcept { return comm_; }

  /// How many ranks share this rank's machine. Collective.
  [[nodiscard]] int ranks_on_machine() const;
  void barrier() const;                                     ///< collective
  [[nodiscard]] std::int64_t sum(std::int64_t mine) const;  ///< collective
  [[nodiscard]] std::int64_t min(std::int64_t mine) const;  ///< collective
  [[nodiscard]] std::int64_t max(std::int64_t mine) const;  ///< collective
  /// Collective; no rounding. NaN on any rank gives NaN on every rank; -0 is below +0: the same bits for any rank
  /// count.
  [[nodiscard]] double min(double mine) const;
  [[nodiscard]] double max(double mine) const;     ///< as min(double)
  void sum(std::span<std::int64_t> values) const;  ///< collective, in place
  void max(std::span<double> values) const;        ///< collective, in place; NaN as in max(double)
  void max(std::span<std::int64_t> values) const;  ///< collective, in place
  /// Sum of `mine` over the ranks below this one; 0 on rank 0. Collective.
  [[nodiscard]] std::int64_t sum_below(std::int64_t mine) const;
  /// Rank `root`'s bytes on every rank. Collective.
  [[nodiscard]] std::string broadcast(Rank root, std::string_view words) const;
  /// Every rank's `mine`, rank after rank, on rank 0; nothing on the others. As many values on each. Collective. Not
  /// for the step loop: O(ranks) memory on rank 0.
  [[nodiscard]] std::vector<std::int64_t> gather(std::span<const std::int64_t> mine) const;

  [[nodiscard]] const Counters& counters() const noexcept { return counters_; }
  /// Local. Books messages that a library sends on this communicator for us.
  void count(Purpose purpose, Traffic traffic) const noexcept;

 private:
  [[nodiscard]] std::int64_t reduce(std::int64_t mine, MPI_Op operation) const;
  void reduce(std::span<std::int64_t> values, MPI_Op operation) const;

  MPI_Comm comm_ = MPI_COMM_NULL;
  Rank rank_ = 0;
  int size_ = 1;
  mutable bool odd_exchange_ = false;  // two exchanges in a row use different tags
  mutable Counters counters_;
  friend std::vector<Parcel> exchange(const Comm& comm, std::vector<Parcel> outgoing, Purpose purpose,
                                      int longest_message);
};

/// An Error that all ranks throw at the same place, with the same words: agree() throws it, nobody else does.
class AgreedError : public Error {
 public:
  using Error::Error;
};

/// What was thrown, as words for the user.
struct Failure {
  ExitCode code = ExitCode::done;
  std::string words;
};
/// The exception at hand, of any type; std::bad_alloc as memory_words(). `otherwise` is the code of what is neither an
/// Error nor want of memory. Only within a catch block. Local.
[[nodiscard]] Failure caught(ExitCode otherwise);

/// Collective. Every rank returns, or every rank throws the complaint of the lowest rank that has one, with its code,
/// as an AgreedError.
void agree(const Comm& comm, ExitCode code, const std::optional<std::string>& complaint);

/// Collective, for what all ranks know: throws `words`, of rank 0, on every rank, as agree() does.
[[noreturn]] void fail_together(const Comm& comm, ExitCode code, const std::string& words);

/// Collective. Runs `action` (local work only, no communication inside) on every rank; an Error thrown on any rank is
/// thrown on all, with its words and code; want of memory becomes an Error(numerical_failure), any other exception an
/// Error(io_failure).
template <class Action>
void agree_on(const Comm& comm, Action&& action);

/// Collective. Runs `action`, which may be collective itself, and catches whatever it throws: what came of it, the same
/// on all ranks; code done if nothing was thrown. Only an AgreedError is known to be everybody's. After any other the
/// rank waits `patience` seconds: if all the others come here, too, the lowest rank's words are those of all; else they
/// may wait for this one for ever, and it ends the job with one line (abort_all). Cost: a communicator.
[[nodiscard]] Failure end_together(const Comm& comm, const std::function<void()>& action, double patience = 2.0);

/// Collective. Sends each parcel to its rank and returns what the others sent here, sorted by source rank.
/// Nobody needs to know beforehand who sends to him (non-blocking consensus, Hoefler et al. 2010); no O(ranks) arrays.
/// A parcel to oneself is delivered, an empty one too. At most one parcel per destination (asserted), of any length:
/// it is sent in messages of at most `longest_message` bytes. Cost: O(parcels) messages, counted as sent for `purpose`.
[[nodiscard]] std::vector<Parcel> exchange(const Comm& comm, std::vector<Parcel> outgoing,
                                           Purpose purpose = Purpose::other, int longest_message = 1 << 30);

/// Fewest ranks at which relay() goes by way of others: from here on two short hops are fewer messages than half of
/// all.
inline constexpr int relay_ranks = 16;

/// Collective. As exchange(), for parcels that go to nearly all ranks: on `fewest` ranks or more by way of one rank
/// between, at most 2 (ceil(sqrt(P)) - 1) messages a rank in place of P - 1, each byte sent twice. Memory: what passes
/// through a rank, about what it sends, is held beside what it sends and receives.
[[nodiscard]] std::vector<Parcel> relay(const Comm& comm, std::vector<Parcel> outgoing,
                                        Purpose purpose = Purpose::other, int fewest = relay_ranks);

template <class Action>
void agree_on(const Comm& comm, Action&& action) {
  std::optional<std::string> words;
  ExitCode code = ExitCode::done;
  try {
    action();
  } catch (...) {
    const Failure failure = caught(ExitCode::io_failure);
    words = failure.words;
    code = failure.code;
  }
  agree(comm, code, words);
}

}  // namespace packmpi::comm
