#include "mesh/near_memory.hpp"

#include <algorithm>
#include <bit>

#include "mesh/vectors.hpp"

namespace packmpi::mesh {

void NearMemory::begin() {
  if (2 * asked_ > entries_.size()) entries_.assign(std::bit_ceil(4 * asked_), {});
  asked_ = 0;
}

bool NearMemory::holds(const Entry& entry, GlobalId id, const Vec3& x, double range) const {
  const double spare = entry.range - range;
  if (entry.id != id || !(spare > 0.0)) return false;
  const Vec3 moved = minus(x, entry.x);
  return dot(moved, moved) < (1.0 - 1e-9) * (spare * spare);
}

void NearMemory::keep(Entry& entry) const {
  if (found_.feature.size() > most_features || found_.triangles.size() > most_triangles) {
    entry.id = -1;
    return;
  }
  std::ranges::copy(found_.feature, entry.feature.begin());
  std::ranges::copy(found_.end, entry.end.begin());
  std::ranges::copy(found_.triangles, entry.triangle.begin());
  entry.features = static_cast<std::int32_t>(found_.feature.size());
}

// Faces that have come out of reach are left out.
void NearMemory::look_through(const Entry& entry, const Surface& surface, const Vec3& x, double range, double deepest) {
  found_.clear();
  const Table table = surface.features().table(deepest);
  std::int32_t begin = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(entry.features); begin = entry.end.at(k), ++k) {
    const std::int32_t feature = entry.feature.at(k);
    if (feature < table.edge_begin) {
      const double* plane = table.faces + 4 * std::int64_t{feature};
      const double distance = plane[3] - along(plane, x.data());
      if (!(distance < range && distance > -(deepest + range))) continue;
      for (std::int32_t t = begin; t < entry.end.at(k); ++t) {
        found_.triangles.push_back(entry.triangle.at(static_cast<std::size_t>(t)));
      }
    }
    found_.feature.push_back(feature);
    found_.end.push_back(static_cast<std::int32_t>(found_.triangles.size()));
  }
}

const NearFeatures& NearMemory::near(const Surface& surface, GlobalId id, const Vec3& x, double range, double margin,
                                     double deepest) {
  found_.clear();
  if (surface.is_clear(x, range)) return found_;
  ++asked_;
  if (entries_.empty()) {
    surface.near(x, range, deepest, found_);
    return found_;
  }
  Entry& entry = entries_[static_cast<std::size_t>(id) & (entries_.size() - 1)];
  if (!holds(entry, id, x, range)) {
    entry.id = id, entry.x = x, entry.range = range + margin;
    surface.near(x, entry.range, deepest, found_);
    keep(entry);
    if (entry.id < 0) return found_;
  }
  look_through(entry, surface, x, range, deepest);
  return found_;
}

std::size_t NearMemory::bytes() const noexcept {
  return entries_.capacity() * sizeof(Entry) + found_.seen.capacity() * sizeof(std::uint32_t);
}

}  // namespace packmpi::mesh
