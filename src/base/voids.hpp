/// The same density in the words of other trades: solid fraction phi, porosity n, void ratio e.
#pragma once

namespace packmpi {

/// n = 1 - phi: voids over all [-].
[[nodiscard]] constexpr double porosity(double solid_fraction) noexcept { return 1.0 - solid_fraction; }
/// e = (1 - phi) / phi: voids over solid [-]; infinite where nothing is solid.
[[nodiscard]] constexpr double void_ratio(double solid_fraction) noexcept {
  return (1.0 - solid_fraction) / solid_fraction;
}
/// phi of a porosity [-].
[[nodiscard]] constexpr double fraction_of_porosity(double n) noexcept { return 1.0 - n; }
/// phi of a void ratio [-].
[[nodiscard]] constexpr double fraction_of_void_ratio(double e) noexcept { return 1.0 / (1.0 + e); }

}  // namespace packmpi
