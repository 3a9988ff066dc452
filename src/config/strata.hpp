/// What a stratum is made of.
#pragma once
#include <cstddef>

#include "config/input.hpp"

namespace packmpi::input {

/// Share of component k in a stratum; only ratios count. One that names no shares has those of the components. Local.
[[nodiscard]] inline double share_in(const Input& in, const Stratum& one, std::size_t k) {
  return one.shares.empty() ? in.components[k].share : one.shares[k];
}

}  // namespace packmpi::input
