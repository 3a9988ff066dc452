/// How long to go on throwing, and how many trials at a time.
#pragma once
#include <cstdint>

#include "rsa/sampler.hpp"

namespace packmpi::rsa {

/// Looks at the hits after 16, 32, 64 ... attempts, and tells when the attempts left cannot place everything. The
/// answer is the same for any number of ranks.
class Outlook {
 public:
  explicit Outlook(std::uint32_t limit) : limit_(limit) {}

  /// Trials thrown in some attempts by the serial loop, and those of them kept. No volley passes a look.
  void record(std::int64_t trials, std::int64_t kept) noexcept {
    trials_ += trials;
    kept_ += kept;
  }
  /// Asked before each volley. A trial's chance p never grows, so at least unplaced * (1 - p)^left particles will
  /// remain after the `left` attempts, on average: more than sqrt(unplaced) if p * left < ln(unplaced) / 2. p is taken
  /// three standard deviations high, and few particles may always try on.
  [[nodiscard]] bool hopeless(std::uint32_t attempt, std::int64_t unplaced) noexcept;
  /// The attempt of the next look.
  [[nodiscard]] static std::uint32_t next_look(std::uint32_t attempt) noexcept;

 private:
  std::uint32_t limit_;
  std::int64_t trials_ = 0;  // since the last look
  std::int64_t kept_ = 0;
};

/// How many attempts to throw together: enough to pay for the messages, few enough that most trials are used. Changes
/// no result.
class Pace {
 public:
  explicit Pace(int ranks) : enough_(10000.0 * ranks) {}

  void record(std::int64_t trials, std::int64_t kept) noexcept {
    hit_every_ = static_cast<double>(trials) / static_cast<double>(kept + 1);
  }
  /// The volley from `attempt` on, up to the next look or the limit at most.
  [[nodiscard]] Volley next(std::uint32_t attempt, std::int64_t unplaced, std::uint32_t limit) const noexcept;

 private:
  double enough_;           // trials on all ranks
  double hit_every_ = 1.0;  // trials for one that is kept, lately
};

}  // namespace packmpi::rsa
