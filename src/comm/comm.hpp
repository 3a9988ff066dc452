/// A communicator and the collectives the other rooms need, on spans and values; no raw MPI elsewhere.
/// Every function that says "collective" is called by all ranks in the same order.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <mpi.h>

#include "base/error.hpp"
#include "base/types.hpp"

namespace packmpi::comm {

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

  [[nodiscard]] Rank rank() const noexcept { return rank_; }
  [[nodiscard]] int size() const noexcept { return size_; }
  [[nodiscard]] MPI_Comm handle() const noexcept { return comm_; }

  void barrier() const;                                             ///< collective
  [[nodiscard]] std::int64_t sum(std::int64_t mine) const;          ///< collective
  [[nodiscard]] std::int64_t min(std::int64_t mine) const;          ///< collective
  [[nodiscard]] std::int64_t max(std::int64_t mine) const;          ///< collective
  [[nodiscard]] double min(double mine) const;                      ///< collective; exact, no rounding
  [[nodiscard]] double max(double mine) const;                      ///< collective; exact, no rounding
  void sum(std::span<std::int64_t> values) const;                   ///< collective, in place
  void max(std::span<double> values) const;                         ///< collective, in place
  void max(std::span<std::int64_t> values) const;                   ///< collective, in place
  /// Sum of `mine` over the ranks below this one; 0 on rank 0. Collective.
  [[nodiscard]] std::int64_t sum_below(std::int64_t mine) const;
  /// Rank `root`'s bytes on every rank. Collective.
  [[nodiscard]] std::string broadcast(Rank root, std::string_view words) const;

 private:
  MPI_Comm comm_ = MPI_COMM_NULL;
  Rank rank_ = 0;
  int size_ = 1;
};

/// Collective. Every rank returns, or every rank throws the complaint of the lowest rank that has one.
void agree(const Comm& comm, ExitCode code, const std::optional<std::string>& complaint);

/// Collective. Runs `action` (local work only, no communication inside) on every rank; an Error thrown on any rank is
/// thrown on all, with its words and code.
template <class Action>
void agree_on(const Comm& comm, Action&& action);

/// Collective. The sum of all ranks' terms, correctly independent of their order and of the number of ranks:
/// each term is rounded to a multiple of 2^-96 of the power of two above the largest magnitude and added in 128-bit integers.
/// NaN or infinity in any term gives NaN on every rank. Terms: at most 2^30 over all ranks. Cost: two reductions.
[[nodiscard]] double exact_sum(const Comm& comm, std::span<const double> terms);
/// The same for several sums at once: terms[k] are the terms of sum k. Cost: two reductions in all.
[[nodiscard]] std::vector<double> exact_sums(const Comm& comm, std::span<const std::vector<double>> terms);

/// A block of bytes and the rank it goes to or came from.
struct Parcel {
  Rank rank;
  std::vector<std::byte> bytes;
};

/// Collective. Sends each parcel to its rank and returns what the others sent here, sorted by source rank.
/// Nobody needs to know beforehand who sends to him (non-blocking consensus, Hoefler et al. 2010); no O(ranks) arrays.
/// A parcel to oneself is delivered. At most one parcel per destination. Cost: O(parcels) messages.
[[nodiscard]] std::vector<Parcel> exchange(const Comm& comm, std::vector<Parcel> outgoing);

template <class Action>
void agree_on(const Comm& comm, Action&& action) {
  std::optional<std::string> words;
  int code = 0;
  try {
    action();
  } catch (const Error& error) {
    words = error.what();
    code = static_cast<int>(error.code());
  } catch (const std::exception& error) {
    words = error.what();
    code = static_cast<int>(ExitCode::io_failure);
  }
  const auto first = comm.min(words ? std::int64_t{comm.rank()} : std::int64_t{comm.size()});
  if (first == comm.size()) return;
  const std::string packed = comm.broadcast(static_cast<Rank>(first), static_cast<char>(code) + words.value_or(""));
  throw Error(static_cast<ExitCode>(packed[0]), packed.substr(1));
}

}  // namespace packmpi::comm
