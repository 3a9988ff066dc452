/// Vectors that grow by an eighth, not to the double: memory per particle is a figure we state.
#pragma once
#include <cstddef>
#include <vector>

namespace packmpi {

/// v.resize(size, value), allocating at most an eighth more than asked. Local.
template <class T>
void resize_tightly(std::vector<T>& v, std::size_t size, const T& value = {}) {
  if (size > v.capacity()) v.reserve(size + size / 8);
  v.resize(size, value);
}

}  // namespace packmpi
