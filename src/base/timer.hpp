/// Wall time, and where it went.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace packmpi {

/// Wall time since its construction, on a clock that never goes back.
class Stopwatch {
 public:
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// Wall time of named phases of the work, added up over their visits. A phase inside another counts in both. Local.
class Phases {
 public:
  struct Phase {
    std::string name;
    double seconds = 0.0;
    std::int64_t visits = 0;
  };

  /// Counts from its making to its end of scope. The Phases must outlive it.
  class Visit {
   public:
    Visit(Phases& phases, std::size_t index) : phases_(phases), index_(index) {}
    ~Visit() { phases_.phases_[index_].seconds += watch_.seconds(), ++phases_.phases_[index_].visits; }
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;

   private:
    Phases& phases_;
    std::size_t index_;
    Stopwatch watch_;
  };

  /// `const auto visit = phases.visit("rsa");` Cost: a search among the few names, two clock readings.
  [[nodiscard]] Visit visit(std::string_view name) { return {*this, index_of(name)}; }
  /// In the order of the first visits; a phase still being visited lacks that visit.
  [[nodiscard]] const std::vector<Phase>& all() const noexcept { return phases_; }
  /// Seconds of one phase; 0 if it was never visited.
  [[nodiscard]] double seconds(std::string_view name) const {
    const auto found = find(name);
    return found == phases_.end() ? 0.0 : found->seconds;
  }

 private:
  [[nodiscard]] std::vector<Phase>::const_iterator find(std::string_view name) const {
    return std::find_if(phases_.begin(), phases_.end(), [name](const Phase& p) { return p.name == name; });
  }
  std::size_t index_of(std::string_view name) {
    const auto index = static_cast<std::size_t>(find(name) - phases_.begin());
    if (index == phases_.size()) phases_.push_back({std::string(name)});
    return index;
  }

  std::vector<Phase> phases_;
};

}  // namespace packmpi
