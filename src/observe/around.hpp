/// The neighbours of each particle, in an order that no rank changes. Private to this module.
#pragma once
#include <span>
#include <vector>

#include "observe/analysis.hpp"

namespace packmpi::observe {

/// Of every owned particle, the slots of those nearer than `factor` (r_i + r_j), at most range, by id. Local.
/// Memory: 8 bytes a neighbour while it is made.
class Around {
 public:
  Around(const Specimen& pack, double factor);
  [[nodiscard]] std::span<const LocalIndex> of(LocalIndex i) const {
    const auto k = static_cast<std::size_t>(i);
    return {slots_.data() + start_[k], start_[k + 1] - start_[k]};
  }

 private:
  std::vector<std::size_t> start_;
  std::vector<LocalIndex> slots_;
};

}  // namespace packmpi::observe
