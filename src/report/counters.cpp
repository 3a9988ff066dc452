#include <algorithm>
#include <numeric>

#include "report/record.hpp"

namespace packmpi::report {

std::int64_t RankNumbers::sum() const { return std::accumulate(of_rank.begin(), of_rank.end(), std::int64_t{0}); }

std::int64_t RankNumbers::max() const { return of_rank.empty() ? 0 : *std::ranges::max_element(of_rank); }

double RankNumbers::imbalance() const {
  const auto total = static_cast<double>(sum());
  return total > 0.0 ? static_cast<double>(max()) * static_cast<double>(of_rank.size()) / total : 1.0;
}

const RankNumbers* find(const std::vector<RankNumbers>& all, const std::string& name) {
  const auto found = std::ranges::find(all, name, &RankNumbers::name);
  return found == all.end() ? nullptr : &*found;
}

double moving_share(const RunRecord& record) {
  const RankNumbers* moving = find(record.counters, "particle_steps");
  const RankNumbers* frozen = find(record.counters, "frozen_steps");
  if (moving == nullptr || frozen == nullptr || moving->sum() == 0) return 1.0;
  return static_cast<double>(moving->sum()) / static_cast<double>(moving->sum() + frozen->sum());
}

std::string missed_words(const RunRecord& record, std::string_view between) {
  std::string words;
  for (const std::string& target : record.missed) words.append(words.empty() ? "" : between).append(target);
  return words;
}

}  // namespace packmpi::report
