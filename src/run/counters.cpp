#include "run/counters.hpp"

#include <array>
#include <cmath>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include "base/memory.hpp"

namespace packmpi::run {
namespace {

struct Number {
  std::string name, unit;
  std::int64_t mine;
};

constexpr std::array<const char*, comm::purposes> purpose_names{"ghost",     "halo",   "migration", "frozen",
                                                                "insertion", "output", "other"};

std::vector<Number> counts_of(const Bed& bed, std::int64_t touching) {
  const dynamics::Work& work = bed.stepper.work();
  const neighbor::Effort& effort = bed.neighborhood.effort();
  const comm::Counters& traffic = bed.comm.counters();
  std::vector<Number> counts{{"owned", "", bed.store.owned()},
                             {"ghosts", "", bed.neighborhood.halo().ghosts()},
                             {"listed_pairs", "", std::ssize(bed.neighborhood.pairs().first)},
                             {"touching_pairs", "", touching},
                             {"particle_steps", "", work.particle_steps},
                             {"frozen_steps", "", work.frozen_steps},
                             {"ghost_steps", "", work.ghost_steps},
                             {"pair_steps", "", work.pair_steps},
                             {"rebuilds", "", effort.rebuilds},
                             {"candidates", "", effort.candidates},
                             {"reductions", "", traffic.reductions},
                             {"exchanges", "", traffic.exchanges}};
  for (std::size_t k = 0; k < comm::purposes; ++k) {
    counts.push_back({std::string(purpose_names[k]) + "_messages", "", traffic.sent[k].messages});
    counts.push_back({std::string(purpose_names[k]) + "_bytes", "B", traffic.sent[k].bytes});
  }
  return counts;
}

std::vector<Number> costs_of(const Bed& bed) {
  const auto nanoseconds = [](double seconds) { return static_cast<std::int64_t>(std::llround(seconds * 1e9)); };
  const neighbor::Effort& effort = bed.neighborhood.effort();
  const auto allocated = static_cast<std::int64_t>(bed.bytes());
  const double cpu = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  return {{"cpu", "ns", nanoseconds(cpu)},
          {"stepping", "ns", nanoseconds(bed.stepping)},
          {"waiting", "ns", nanoseconds(effort.waiting)},
          {"refreshing", "ns", nanoseconds(effort.refreshing)},
          {"rebuilding", "ns", nanoseconds(effort.rebuilding)},
          {"inserting", "ns", nanoseconds(bed.inserting)},
          {"allocated", "B", allocated},
          {"memory", "B", memory_high_water()}};
}

// On rank 0; nothing on the others.
std::vector<report::RankNumbers> gathered(const comm::Comm& comm, const std::vector<Number>& numbers) {
  std::vector<std::int64_t> mine;
  mine.reserve(numbers.size());
  for (const Number& number : numbers) mine.push_back(number.mine);
  const std::vector<std::int64_t> all = comm.gather(mine);
  std::vector<report::RankNumbers> result;
  for (std::size_t k = 0; k < numbers.size() && !all.empty(); ++k) {
    result.push_back({numbers[k].name, numbers[k].unit, {}});
    for (std::size_t at = k; at < all.size(); at += numbers.size()) result.back().of_rank.push_back(all[at]);
  }
  return result;
}

}  // namespace

void count(const Bed& bed, std::int64_t touching, report::RunRecord& record) {
  record.counters = gathered(bed.comm, counts_of(bed, touching));
  record.costs = gathered(bed.comm, costs_of(bed));
}

}  // namespace packmpi::run
