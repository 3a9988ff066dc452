/// Which darts of a volley stay, when they stand against each other across ranks.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "comm/comm.hpp"
#include "rsa/border.hpp"
#include "rsa/cells.hpp"
#include "rsa/mail.hpp"
#include "rsa/sphere.hpp"
#include "rsa/thrower.hpp"

namespace packmpi::rsa {

/// What is known of a dart.
enum class Verdict : std::uint8_t { open, kept, rejected };

/// Finds the lexicographically first independent set of a volley's darts, as the serial loop would: two darts exclude
/// each other if they overlap or are of the same particle; a dart is kept when every earlier one that excludes it is
/// rejected, and rejected when such a one is kept. A rank is told of the foreign darts near its border, and of earlier
/// darts of particles that it may have darts of; a dart that waits for a foreign one stays open until that one's rank
/// tells. In each round at least the lowest open dart of all ranks is decided, so the rounds are bounded.
class Conflicts {
 public:
  /// `placed` holds the spheres placed so far, foreign ones near the border too, and is extended by resolve().
  Conflicts(const comm::Comm& comm, const CellGrids& grid, const Metric& metric, const Border& border,
            const Thrower& thrower, Bins& placed)
      : comm_(&comm), border_(&border), thrower_(&thrower), placed_(&placed), undecided_(grid, metric) {}

  /// Totals over all ranks.
  struct Outcome {
    std::int64_t kept;    ///< darts kept
    std::int64_t thrown;  ///< darts of the particles kept, as the serial loop counts: none after the one kept
  };
  /// Collective. `darts`: this rank's, in order of turn(), none of them overlapping a placed sphere.
  Outcome resolve(std::span<const Dart> darts, const Volley& volley);
  /// Of the k-th dart given to resolve().
  [[nodiscard]] bool kept(std::size_t k) const noexcept { return verdicts_[k] == Verdict::kept; }
  /// True if a volley of several attempts placed the particle, on any rank. Only for particles whose last dart is this
  /// rank's.
  [[nodiscard]] bool placed_earlier(std::uint64_t particle) const;

 private:
  struct Announcement {
    Dart dart;
    std::int64_t near;  // 1 if near the receiver's border, 0 if sent for its particle only
  };
  struct News {  // a decided dart
    std::uint64_t particle;
    std::uint32_t attempt;
    std::uint32_t kept;
  };
  struct Told {  // own dart `dart` is known to `rank`
    std::int32_t dart;
    Rank rank;
  };
  void announce(const Volley& volley);
  void tell(std::int32_t dart, Rank rank, bool near);
  void take_in(std::vector<Announcement> foreign);
  void decide(bool first);
  void settle(std::int32_t dart, Verdict verdict);
  void hear();
  [[nodiscard]] Verdict ruling(const Dart& dart) const;
  [[nodiscard]] Verdict ruling_of_particle(const Dart& dart) const;
  [[nodiscard]] std::span<const std::int32_t> of_particle(std::uint64_t particle) const;

  const comm::Comm* comm_;
  const Border* border_;
  const Thrower* thrower_;
  Bins* placed_;
  Bins undecided_;                         // near foreign darts, and own ones that wait; tags are indices into darts_
  std::vector<Dart> darts_;                // own, then foreign ones; each part in order of turn()
  std::vector<Verdict> verdicts_;          // of darts_
  std::vector<char> near_;                 // of the foreign part of darts_
  std::vector<std::int32_t> by_particle_;  // darts_ by particle, then attempt; empty in a volley of one attempt
  std::vector<std::int32_t> open_;         // own darts still open, ascending
  std::vector<Told> told_;                 // ascending by dart
  std::size_t own_ = 0;
  std::uint32_t first_attempt_ = 0;
  Outcome outcome_{};  // of this rank
  Mailbox<Announcement> announcements_;
  Mailbox<News> news_;
};

}  // namespace packmpi::rsa
