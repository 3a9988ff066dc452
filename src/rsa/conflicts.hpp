/// Which trials of a volley stay, when they stand against each other across ranks.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "comm/comm.hpp"
#include "rsa/border.hpp"
#include "rsa/cells.hpp"
#include "rsa/mail.hpp"
#include "rsa/placed.hpp"
#include "rsa/sampler.hpp"
#include "rsa/sphere.hpp"

namespace packmpi::rsa {

/// What is known of a trial.
enum class Verdict : std::uint8_t { open, kept, rejected };

/// Finds the lexicographically first independent set of a volley's trials, as the serial loop would: two trials exclude
/// each other if they overlap or are of the same particle; a trial is kept when every earlier one that excludes it is
/// rejected, and rejected when such a one is kept. A rank is told of the foreign trials near its border, and of earlier
/// trials of particles that it may have trials of; a trial that waits for a foreign one stays open until that one's
/// rank tells. In each round at least the lowest open trial of all ranks is decided, so the rounds are bounded.
class Conflicts {
 public:
  /// `placed` holds the spheres placed so far, foreign ones near the border too, and is extended by resolve().
  Conflicts(const comm::Comm& comm, const CellGrids& grid, const Metric& metric, const Border& border,
            const Sampler& sampler, Placed& placed)
      : comm_(&comm), border_(&border), sampler_(&sampler), placed_(&placed), undecided_(grid, metric) {}

  /// Totals over all ranks.
  struct Outcome {
    std::int64_t kept;    ///< trials kept
    std::int64_t thrown;  ///< trials of the particles kept, as the serial loop counts: none after the one kept
  };
  /// Collective. `trials`: this rank's, in order of turn(), none of them overlapping a placed sphere.
  Outcome resolve(std::span<const Trial> trials, const Volley& volley);
  /// Of the k-th trial given to resolve().
  [[nodiscard]] bool kept(std::size_t k) const noexcept { return verdicts_[k] == Verdict::kept; }
  /// True if a volley of several attempts placed the particle, on any rank. Only for particles whose last trial is this
  /// rank's.
  [[nodiscard]] bool placed_earlier(std::uint64_t particle) const;

 private:
  struct Announcement {
    Trial trial;
    std::int64_t near;  // 1 if near the receiver's border, 0 if sent for its particle only
  };
  struct News {  // a decided trial
    std::uint64_t particle;
    std::uint32_t attempt;
    std::uint32_t kept;
  };
  struct Told {  // own trial `trial` is known to `rank`
    std::int32_t trial;
    Rank rank;
  };
  void announce(const Volley& volley);
  void tell(std::int32_t trial, Rank rank, bool near);
  void take_in(std::vector<Announcement> foreign);
  void decide(bool first);
  void settle(std::int32_t trial, Verdict verdict);
  void hear();
  [[nodiscard]] Verdict ruling(const Trial& trial) const;
  [[nodiscard]] Verdict ruling_of_particle(const Trial& trial) const;
  [[nodiscard]] std::span<const std::int32_t> of_particle(std::uint64_t particle) const;

  const comm::Comm* comm_;
  const Border* border_;
  const Sampler* sampler_;
  Placed* placed_;
  Bins undecided_;                         // near foreign trials, and own ones that wait; tags are indices into trials_
  std::vector<Trial> trials_;              // own, then foreign ones; each part in order of turn()
  std::vector<Verdict> verdicts_;          // of trials_
  std::vector<char> near_;                 // of the foreign part of trials_
  std::vector<std::int32_t> by_particle_;  // trials_ by particle, then attempt; empty in a volley of one attempt
  std::vector<std::int32_t> open_;         // own trials still open, ascending
  std::vector<Told> told_;                 // ascending by trial
  std::size_t own_ = 0;
  std::uint32_t first_attempt_ = 0;
  Outcome outcome_{};  // of this rank
  Mailbox<Announcement> announcements_;
  Mailbox<News> news_;
};

}  // namespace packmpi::rsa
