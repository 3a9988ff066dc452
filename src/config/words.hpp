/// The words of every enumeration of a scene file, in the order of its enumerators.
#pragma once
#include <array>
#include <string_view>

#include "config/input.hpp"

namespace packmpi::input {

template <class Enum>
inline constexpr std::array<std::string_view, 0> words_of{};

template <>
inline constexpr std::array<std::string_view, 10> words_of<VesselShape>{
    "box", "cylinder", "frustum", "sphere", "annulus", "prism", "mesh", "circle", "trapezium", "polygon"};
template <>
inline constexpr std::array<std::string_view, 4> words_of<Body>{"sphere", "cylinder", "box", "mesh"};
template <>
inline constexpr std::array<std::string_view, 3> words_of<Axis>{"x", "y", "z"};
template <>
inline constexpr std::array<std::string_view, 2> words_of<Boundary>{"wall", "periodic"};
template <>
inline constexpr std::array<std::string_view, 9> words_of<SizeDistribution>{
    "equal", "gaussian", "uniform", "lognormal", "weibull", "bidisperse", "discrete", "grading", "list"};
template <>
inline constexpr std::array<std::string_view, 3> words_of<Weighting>{"number", "mass", "area"};
template <>
inline constexpr std::array<std::string_view, 2> words_of<ListOrder>{"random", "file"};
template <>
inline constexpr std::array<std::string_view, 2> words_of<Interpolation>{"log", "linear"};
template <>
inline constexpr std::array<std::string_view, 2> words_of<HeightRule>{"surface", "highest"};
template <>
inline constexpr std::array<std::string_view, 2> words_of<RegionRule>{"open", "container"};
template <>
inline constexpr std::array<std::string_view, 2> words_of<FrictionVelocity>{"contact", "centre"};
template <>
inline constexpr std::array<std::string_view, 2> words_of<Tangential>{"sliding", "mindlin"};
template <>
inline constexpr std::array<std::string_view, 4> words_of<Regularisation>{"stop", "shared", "viscous", "none"};
template <>
inline constexpr std::array<std::string_view, 2> words_of<WallStiffness>{"rigid", "material"};
template <>
inline constexpr std::array<std::string_view, 2> words_of<StopRule>{"duration", "settled"};
template <>
inline constexpr std::array<std::string_view, 2> words_of<TargetState>{"filled", "confined"};
template <>
inline constexpr std::array<std::string_view, 3> words_of<Decomposition>{"slab", "pencil", "metis"};

/// The word a scene file uses for `value`.
template <class Enum>
[[nodiscard]] constexpr std::string_view word(Enum value) {
  return words_of<Enum>.at(static_cast<std::size_t>(value));
}

}  // namespace packmpi::input
