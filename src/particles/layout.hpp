/// Which fields a particle has in memory: chosen once from the scene, nothing is stored for a feature that is off.
///
/// A particle is one record of doubles, so that a force kernel loads it with two or three vector instructions:
///   3D, rotation  12 doubles  { x y z r | vx vy vz k | sx sy sz - }
///   3D             8 doubles  { x y z r | vx vy vz k }
///   2D, rotation   8 doubles  { x y r k | vx vy s - }
///   2D             6 doubles  { x y r k | vx vy }
/// and with several components four more, after them or after the eighth: { c w - - }.
/// r radius [m]; k = 1/r [1/m] (gives 1/m = 3 k^3 / (4 pi rho) and, added over a pair, 1/r*);
/// s = r omega [m/s]: the surface speed of the spin, so that a contact adds two records to get its slip.
/// c names the component, w = 1/m [1/kg].
/// In 3D r and k fill lanes that alignment would leave empty.
#pragma once
#include <cstddef>

namespace packmpi::particles {

/// Where each field lies in a record, in doubles from its start. `spin` is -1 when rotation is off.
struct Layout {
  int dimension;
  bool rotation;
  int stride;    ///< doubles a record
  int position;  ///< always 0
  int radius;
  int curvature;  ///< 1 / radius
  int velocity;
  int spin;            ///< r * omega: 3 components in 3D, 1 (about +z) in 2D; -1 if absent
  int component = -1;  ///< its code (scene/mixture.hpp), then 1 / mass; -1 if all particles are of one material

  [[nodiscard]] constexpr int spin_components() const { return rotation ? (dimension == 3 ? 3 : 1) : 0; }
  /// Doubles of a record that mean something, from its start; behind them there is padding, and what follows from the
  /// particle's component.
  [[nodiscard]] constexpr int used_doubles() const { return rotation ? spin + spin_components() : 2 * (dimension + 1); }
  /// Doubles a ghost receives in every step: position, velocity, spin.
  [[nodiscard]] constexpr int live_doubles() const { return 2 * dimension + spin_components(); }
  [[nodiscard]] constexpr std::size_t record_bytes() const { return sizeof(double) * static_cast<std::size_t>(stride); }
  friend constexpr bool operator==(const Layout&, const Layout&) = default;
};

/// The layout of a scene's features.
[[nodiscard]] constexpr Layout layout_of(int dimension, bool rotation, bool mixture = false) {
  Layout layout = {2, rotation, rotation ? 8 : 6, 0, 2, 3, 4, rotation ? 6 : -1};
  if (dimension == 3) layout = {3, rotation, rotation ? 12 : 8, 0, 3, 7, 4, rotation ? 8 : -1};
  if (!mixture) return layout;
  layout.component = layout.stride > 8 ? layout.stride : 8;
  layout.stride = layout.component + 4;
  return layout;
}

}  // namespace packmpi::particles
