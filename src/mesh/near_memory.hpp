/// What is near each particle of a bed, remembered from one making of lists to the next.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "base/types.hpp"
#include "mesh/surface.hpp"

namespace packmpi::mesh {

/// Searches reach a little farther than asked, and while a particle has not moved by more than that, what they found is
/// looked through in their place: in a bed most particles hardly move. As many entries as particles near the surface,
/// each at the place that its id has; who comes later takes the place. Of one rank.
class NearMemory {
 public:
  /// Before the particles of a bed are asked for, each once.
  void begin();
  /// All features that are nearer to x than `range` [m], as Surface::near(); valid up to the next call. `margin` [m]:
  /// how much farther to search. Cost: O(what is near), a tenth of that of a search if it is remembered.
  [[nodiscard]] const NearFeatures& near(const Surface& surface, GlobalId id, const Vec3& x, double range,
                                         double margin, double deepest);
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  static constexpr std::size_t most_features = 7, most_triangles = 16;
  struct Entry {
    GlobalId id = -1;
    Vec3 x{};
    double range = 0.0;  ///< [m] around x
    std::array<std::int32_t, most_features> feature{}, end{};
    std::array<std::int32_t, most_triangles> triangle{};
    std::int32_t features = 0;
  };
  [[nodiscard]] bool holds(const Entry& entry, GlobalId id, const Vec3& x, double range) const;
  void keep(Entry& entry) const;
  void look_through(const Entry& entry, const Surface& surface, const Vec3& x, double range, double deepest);

  NearFeatures found_;
  std::vector<Entry> entries_;  // a power of two of them
  std::size_t asked_ = 0;       // since begin(), near the surface
};

}  // namespace packmpi::mesh
