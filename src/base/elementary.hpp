/// Elementary functions of + - * / and square root alone: libm picks its code by CPU, so its last bits may differ from
/// machine to machine; these are the same everywhere. Relative errors are a few 1e-16 (exponential: of e^x near 1 and a
/// few 1e-16 |x| elsewhere).
#pragma once

namespace packmpi::elementary {

/// ln x for finite x > 0.
[[nodiscard]] double logarithm(double x) noexcept;
/// e^x; 0 below -745, infinity above 709.
[[nodiscard]] double exponential(double x) noexcept;
/// base^exponent for finite base > 0.
[[nodiscard]] double power(double base, double exponent) noexcept;
/// sin x for x in [0, pi].
[[nodiscard]] double sine(double x) noexcept;
/// cos x for x in [0, pi/2]; the absolute error is a few 1e-16.
[[nodiscard]] double cosine(double x) noexcept;
/// arcsin x for x in [0, 1].
[[nodiscard]] double arcsine(double x) noexcept;
/// erfc x, the complementary error function, for finite x.
[[nodiscard]] double complementary_error(double x) noexcept;
/// x^(1/3) for finite x > 0.
[[nodiscard]] double cube_root(double x) noexcept;
/// x^(1/5) for finite x > 0.
[[nodiscard]] double fifth_root(double x) noexcept;

}  // namespace packmpi::elementary
