#include "rsa/pace.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace packmpi::rsa {
namespace {

constexpr std::uint32_t first_look = 16;
constexpr std::int64_t few = 128;  // so many particles are never given up early
constexpr double longest_volley = 2000.0;

}  // namespace

// Whole numbers, + - * / and sqrt only: the same on all ranks and CPUs.
bool Outlook::hopeless(std::uint32_t attempt, std::int64_t unplaced) noexcept {
  if (attempt < first_look || !std::has_single_bit(attempt)) return false;
  const auto kept = static_cast<double>(kept_);
  const double chance = (kept + 3.0 * std::sqrt(kept) + 10.0) / static_cast<double>(trials_);
  trials_ = kept_ = 0;
  const auto log2 =
      static_cast<double>(std::bit_width(static_cast<std::uint64_t>(unplaced)) - 1);  // 0.34 log2 x < ln x / 2
  return unplaced >= few && chance * (limit_ - attempt) < 0.34 * log2;
}

std::uint32_t Outlook::next_look(std::uint32_t attempt) noexcept {
  return std::max(first_look, std::bit_floor(attempt) * 2U);
}

Volley Pace::next(std::uint32_t attempt, std::int64_t unplaced, std::uint32_t limit) const noexcept {
  const auto left = static_cast<double>(std::min(Outlook::next_look(attempt), limit) - attempt);
  const double wanted = std::min(0.5 * hit_every_, enough_ / static_cast<double>(unplaced));
  return {attempt, static_cast<std::uint32_t>(std::clamp(wanted, 1.0, std::min(left, longest_volley)))};
}

}  // namespace packmpi::rsa
