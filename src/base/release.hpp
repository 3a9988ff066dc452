/// Giving a vector's memory back.
#pragma once
#include <vector>

namespace packmpi {

/// `values` is empty afterwards and has no memory: `values = {}` would keep it. Local.
template <class T>
void release(std::vector<T>& values) noexcept {
  std::vector<T>().swap(values);
}

}  // namespace packmpi
